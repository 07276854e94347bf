#include "transport/segment.hpp"

#include "core/codec.hpp"

namespace rubicon::transport {

namespace {

constexpr std::uint8_t flag_reliable = 0x01;
constexpr std::uint8_t flag_acknowledgement = 0x02;

} // namespace

bytes encode(const segment& x) {
  byte_writer out;
  out.big(x.source.value).big(x.sequence).octet(x.am_type);
  out.octet(static_cast<std::uint8_t>((x.reliable ? flag_reliable : 0) |
                                      (x.acknowledgement ? flag_acknowledgement : 0)));
  out.append(x.payload);
  return out.finish();
}

result<segment> decode_segment(byte_view octets) {
  byte_reader in(octets);
  segment x;
  x.source = mote_id{in.big<std::uint16_t>()};
  x.sequence = in.big<std::uint16_t>();
  x.am_type = in.octet();
  const auto flags = in.octet();
  if (!in.ok())
    return errc::truncated;
  if (in.remaining() > payload_max)
    return errc::too_long;
  x.reliable = (flags & flag_reliable) != 0;
  x.acknowledgement = (flags & flag_acknowledgement) != 0;
  const auto unknown = static_cast<std::uint8_t>(flags & ~(flag_reliable | flag_acknowledgement));
  if (unknown != 0 || (x.acknowledgement && (x.reliable || in.remaining() > 0)))
    return errc::bad_value;
  x.payload = to_bytes(in.rest());
  return x;
}

} // namespace rubicon::transport
