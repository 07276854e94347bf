#include "radio/books.hpp"

#include <numeric>

namespace rubicon::radio {

std::string to_string(copy_fate x) {
  switch (x) {
  case copy_fate::delivered:
    return "delivered";
  case copy_fate::weak:
    return "weak";
  case copy_fate::loss:
    return "loss";
  case copy_fate::collision:
    return "collision";
  case copy_fate::captured:
    return "captured";
  case copy_fate::half_duplex:
    return "half_duplex";
  case copy_fate::off:
    return "off";
  case copy_fate::filtered:
    return "filtered";
  case copy_fate::overflow:
    return "overflow";
  case copy_fate::duplicate:
    return "duplicate";
  case copy_fate::out_of_reach:
    return "out_of_reach";
  }
  return "unknown";
}

bool copy_book::balanced() const {
  return sent == std::accumulate(ended.begin(), ended.end(), std::uint64_t{0});
}

copy_book& copy_book::operator+=(const copy_book& x) {
  sent += x.sent;
  for (std::size_t i = 0; i < copy_fates; ++i)
    ended[i] += x.ended[i];
  return *this;
}

copy_book link_books::link(std::size_t place) const {
  copy_book x;
  if (rows_ == nullptr)
    return x;
  x.sent = frames_;
  for (std::size_t i = 0; i < copy_fates; ++i)
    x.ended[i] = (*rows_)[i].empty() ? 0 : (*rows_)[i][place];
  return x;
}

bool request_book::balanced() const {
  return requests == sent + no_ack + channel_access_failure + queue_full + aborted + open;
}

request_book& request_book::operator+=(const request_book& x) {
  requests += x.requests;
  sent += x.sent;
  no_ack += x.no_ack;
  channel_access_failure += x.channel_access_failure;
  queue_full += x.queue_full;
  aborted += x.aborted;
  open += x.open;
  return *this;
}

books& books::operator+=(const books& x) {
  copies += x.copies;
  requests += x.requests;
  transmissions += x.transmissions;
  acks += x.acks;
  acks_received += x.acks_received;
  return *this;
}

} // namespace rubicon::radio
