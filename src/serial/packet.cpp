#include "serial/packet.hpp"

#include <cassert>

#include "core/codec.hpp"

namespace rubicon::serial {

bytes encode(const am_packet& x) {
  assert(x.payload.size() <= am_payload_max);
  byte_writer out;
  out.octet(am_dispatch).big(x.destination).big(x.source);
  out.octet(static_cast<std::uint8_t>(x.payload.size())).octet(x.group).octet(x.am_type);
  return out.append(x.payload).finish();
}

result<am_packet> decode_am_packet(byte_view packet) {
  byte_reader in(packet);
  const auto dispatch = in.octet();
  am_packet x;
  x.destination = in.big<std::uint16_t>();
  x.source = in.big<std::uint16_t>();
  const auto length = in.octet();
  x.group = in.octet();
  x.am_type = in.octet();
  if (!packet.empty() && dispatch != am_dispatch)
    return errc::unsupported;
  if (!in.ok())
    return errc::truncated;
  if (length > am_payload_max || in.remaining() > length)
    return errc::too_long;
  if (in.remaining() < length)
    return errc::truncated;
  x.payload = to_bytes(in.rest());
  return x;
}

} // namespace rubicon::serial
