#include "traffic/part.hpp"

#include <cassert>

namespace rubicon::traffic {

part& part::operator+=(const part& x) {
  if (from == mote_address{} && to == mote_address{}) {
    from = x.from;
    to = x.to;
  }
  assert(from == x.from && to == x.to);
  sent += x.sent;
  delivered += x.delivered;
  octets += x.octets;
  transmissions += x.transmissions;
  add_to(lost, x.lost);
  active += x.active;
  delay += x.delay;
  return *this;
}

} // namespace rubicon::traffic
