#include "network/island_packet.hpp"

#include <cassert>

#include "core/codec.hpp"

namespace rubicon::network {

namespace {

/// Checks what both layouts share, once the header has been read.
result<bytes> take_body(byte_reader& in) {
  if (!in.ok())
    return errc::truncated;
  if (in.remaining() > body_max)
    return errc::too_long;
  return to_bytes(in.rest());
}

} // namespace

bytes encode(const island_packet& x) {
  assert(x.body.size() <= body_max);
  byte_writer out(packet_max - body_max + x.body.size());
  out.big(x.island.value).big(x.mote.value).big(x.channel).append(x.body);
  return out.finish();
}

bytes encode(const gateway_packet& x) {
  assert(x.body.size() <= body_max);
  byte_writer out(packet_max - body_max + x.body.size());
  out.big(x.mote.value).big(x.channel).append(x.body);
  return out.finish();
}

result<island_packet> decode_island_packet(byte_view octets) {
  byte_reader in(octets);
  island_packet x;
  x.island = island_id{in.big<std::uint32_t>()};
  x.mote = mote_id{in.big<std::uint16_t>()};
  x.channel = in.big<std::uint16_t>();
  auto body = take_body(in);
  if (!body)
    return body.error();
  x.body = *std::move(body);
  return x;
}

result<gateway_packet> decode_gateway_packet(byte_view octets) {
  byte_reader in(octets);
  gateway_packet x;
  x.mote = mote_id{in.big<std::uint16_t>()};
  x.channel = in.big<std::uint16_t>();
  auto body = take_body(in);
  if (!body)
    return body.error();
  x.body = *std::move(body);
  return x;
}

} // namespace rubicon::network
