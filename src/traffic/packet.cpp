#include "traffic/packet.hpp"

#include <algorithm>
#include <cassert>
#include <limits>

#include "core/codec.hpp"

namespace rubicon::traffic {

namespace {

constexpr std::uint64_t time_max = std::numeric_limits<duration::rep>::max();

bool is_mote(mote_id x) {
  return x.value >= 1 && x.value <= mote_id_max;
}

} // namespace

bytes encode(const packet& x) {
  assert(x.number <= number_max && x.requested >= instant{});
  assert(x.size >= packet_min && x.size <= packet_max);
  byte_writer out;
  out.big(x.origin.value).big(x.target.value);
  out.big(static_cast<std::uint16_t>(x.number >> 32)).big(static_cast<std::uint32_t>(x.number));
  out.big(x.requested.time_since_epoch().count());
  return out.zeros(x.size - packet_min).finish();
}

result<packet> decode_packet(byte_view octets) {
  if (octets.size() > packet_max)
    return errc::too_long;
  byte_reader in(octets);
  packet x;
  x.origin = mote_id{in.big<std::uint16_t>()};
  x.target = mote_id{in.big<std::uint16_t>()};
  x.number = std::uint64_t{in.big<std::uint16_t>()} << 32;
  x.number |= in.big<std::uint32_t>();
  const auto requested_ns = in.big<std::uint64_t>();
  if (!in.ok())
    return errc::truncated;
  const auto padding = in.rest();
  if (!is_mote(x.origin) || (!is_mote(x.target) && x.target != broadcast_mote) ||
      requested_ns > time_max ||
      std::ranges::any_of(padding, [](auto octet) { return octet != 0; }))
    return errc::bad_value;
  x.requested = instant(duration(static_cast<duration::rep>(requested_ns)));
  x.size = octets.size();
  return x;
}

} // namespace rubicon::traffic
