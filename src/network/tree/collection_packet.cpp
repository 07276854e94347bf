#include "network/tree/collection_packet.hpp"

#include <algorithm>
#include <cassert>

#include "core/codec.hpp"
#include "network/tree/source_routes.hpp"

namespace rubicon::network {

namespace {

constexpr std::uint8_t narrow = 0x80;
constexpr std::size_t down_fixed_size = 4;

bool fits_octets(const std::vector<mote_id>& hops) {
  return std::ranges::all_of(hops, [](mote_id x) { return x.value < 256; });
}

} // namespace

std::size_t header_size(const std::vector<mote_id>& hops) {
  return down_fixed_size + hops.size() * (fits_octets(hops) ? 1 : 2);
}

bytes encode(const up_packet& x) {
  byte_writer to(up_packet::header_size + x.content.size());
  to.big(x.origin.value).big(x.parent.value).big(x.sequence).big(x.cost).big(x.hops);
  to.append(x.content);
  return to.finish();
}

bytes encode(const down_packet& x) {
  assert(!x.hops.empty() && x.hops.size() <= source_routes::hops_max && x.at < x.hops.size());
  const bool short_ids = fits_octets(x.hops);
  byte_writer to(header_size(x.hops) + x.content.size());
  to.big(x.sequence);
  to.big(static_cast<std::uint8_t>(x.hops.size() | (short_ids ? narrow : 0))).big(x.at);
  for (const auto hop : x.hops) {
    if (short_ids)
      to.big(static_cast<std::uint8_t>(hop.value));
    else
      to.big(hop.value);
  }
  to.append(x.content);
  return to.finish();
}

bytes encode(const flood_packet& x) {
  byte_writer to(flood_packet::header_size + x.content.size());
  to.big(x.origin.value).big(x.sequence).big(x.hops).append(x.content);
  return to.finish();
}

result<up_packet> decode_up(byte_view octets) {
  byte_reader from(octets);
  up_packet x;
  x.origin = mote_id{from.big<std::uint16_t>()};
  x.parent = mote_id{from.big<std::uint16_t>()};
  x.sequence = from.big<std::uint16_t>();
  x.cost = from.big<etx_cost>();
  x.hops = from.octet();
  if (!from.ok())
    return errc::truncated;
  x.content = to_bytes(from.rest());
  return x;
}

result<down_packet> decode_down(byte_view octets) {
  byte_reader from(octets);
  down_packet x;
  x.sequence = from.big<std::uint16_t>();
  const auto count = from.octet();
  x.at = from.octet();
  const std::size_t hops = count & ~narrow;
  if (from.ok() && (hops == 0 || hops > source_routes::hops_max || x.at >= hops))
    return errc::bad_value;
  for (std::size_t i = 0; i < hops && from.ok(); ++i)
    x.hops.emplace_back((count & narrow) != 0 ? from.octet() : from.big<std::uint16_t>());
  if (!from.ok())
    return errc::truncated;
  x.content = to_bytes(from.rest());
  return x;
}

result<flood_packet> decode_flood(byte_view octets) {
  byte_reader from(octets);
  flood_packet x;
  x.origin = mote_id{from.big<std::uint16_t>()};
  x.sequence = from.big<std::uint16_t>();
  x.hops = from.octet();
  if (!from.ok())
    return errc::truncated;
  x.content = to_bytes(from.rest());
  return x;
}

} // namespace rubicon::network
