#include "gateway/others/strict.hpp"

#include "transport/segment.hpp"

namespace rubicon::gateway {

namespace {

constexpr std::uint16_t am_type_max = 0xff;

} // namespace

std::optional<network::gateway_packet> to_strict(network::gateway_packet x) {
  auto segment = transport::decode_segment(x.body);
  if (x.channel > am_type_max || !segment || segment->what != transport::segment::kind::plain)
    return std::nullopt;
  x.body = std::move(segment->payload);
  return x;
}

std::optional<network::gateway_packet> from_strict(network::gateway_packet x,
                                                   std::uint16_t counter) {
  if (x.channel > am_type_max || x.body.size() > transport::payload_max)
    return std::nullopt;
  transport::segment segment;
  segment.source = no_mote;
  segment.counter = counter & transport::counter_max;
  segment.am_type = static_cast<std::uint8_t>(x.channel);
  segment.payload = std::move(x.body);
  x.body = encode(segment);
  return x;
}

} // namespace rubicon::gateway
