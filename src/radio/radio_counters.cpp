#include "radio/radio_counters.hpp"

#include <numeric>

namespace rubicon::radio {

std::string to_string(copy_outcome x) {
  switch (x) {
  case copy_outcome::delivered:
    return "delivered";
  case copy_outcome::weak:
    return "weak";
  case copy_outcome::loss:
    return "loss";
  case copy_outcome::collision:
    return "collision";
  case copy_outcome::captured:
    return "captured";
  case copy_outcome::half_duplex:
    return "half_duplex";
  case copy_outcome::off:
    return "off";
  case copy_outcome::filtered:
    return "filtered";
  case copy_outcome::overflow:
    return "overflow";
  case copy_outcome::duplicate:
    return "duplicate";
  case copy_outcome::out_of_reach:
    return "out_of_reach";
  }
  return "unknown";
}

bool copy_counters::balanced() const {
  return sent == std::accumulate(ended.begin(), ended.end(), std::uint64_t{0});
}

copy_counters& copy_counters::operator+=(const copy_counters& x) {
  sent += x.sent;
  for (std::size_t i = 0; i < copy_outcomes; ++i)
    ended[i] += x.ended[i];
  return *this;
}

copy_counters link_counters::link(std::size_t place) const {
  copy_counters x;
  if (rows_ == nullptr)
    return x;
  x.sent = frames_;
  for (std::size_t i = 0; i < copy_outcomes; ++i)
    x.ended[i] = (*rows_)[i].empty() ? 0 : (*rows_)[i][place];
  return x;
}

bool request_counters::balanced() const {
  return requests == sent + no_ack + channel_access_failure + queue_full + aborted + open;
}

request_counters& request_counters::operator+=(const request_counters& x) {
  requests += x.requests;
  sent += x.sent;
  no_ack += x.no_ack;
  channel_access_failure += x.channel_access_failure;
  queue_full += x.queue_full;
  aborted += x.aborted;
  open += x.open;
  return *this;
}

radio_counters& radio_counters::operator+=(const radio_counters& x) {
  copies += x.copies;
  requests += x.requests;
  transmissions += x.transmissions;
  acks += x.acks;
  acks_received += x.acks_received;
  return *this;
}

} // namespace rubicon::radio
