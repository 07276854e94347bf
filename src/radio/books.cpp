#include "radio/books.hpp"

namespace rubicon::radio {

bool copy_book::balanced() const {
  return sent == delivered + loss + collision + half_duplex + off + filtered + overflow + duplicate;
}

copy_book& copy_book::operator+=(const copy_book& x) {
  sent += x.sent;
  delivered += x.delivered;
  loss += x.loss;
  collision += x.collision;
  half_duplex += x.half_duplex;
  off += x.off;
  filtered += x.filtered;
  overflow += x.overflow;
  duplicate += x.duplicate;
  return *this;
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
