#include "transport/segment.hpp"

#include "core/codec.hpp"

namespace rubicon::transport {

namespace {

bool is_known(std::uint8_t kind) {
  return kind <= 3 || (kind >= 5 && kind <= 7);
}

} // namespace

bytes encode(const segment& x) {
  byte_writer out(header_size + x.payload.size());
  out.big(x.source.value);
  out.big(static_cast<std::uint16_t>(x.sender << 12 | (x.counter & counter_max)));
  out.octet(x.am_type);
  out.octet(static_cast<std::uint8_t>(x.receiver << 3 | static_cast<std::uint8_t>(x.what)));
  out.append(x.payload);
  return out.finish();
}

result<segment> decode_segment(byte_view octets) {
  byte_reader in(octets);
  segment x;
  x.source = mote_id{in.big<std::uint16_t>()};
  const auto sequence = in.big<std::uint16_t>();
  x.am_type = in.octet();
  const auto flags = in.octet();
  if (!in.ok())
    return errc::truncated;
  if (in.remaining() > payload_max)
    return errc::too_long;
  x.counter = sequence & counter_max;
  x.sender = static_cast<incarnation>(sequence >> 12);
  x.what = static_cast<segment::kind>(flags & 7);
  x.receiver = flags >> 3;
  const bool has_payload = x.what == segment::kind::plain || x.what == segment::kind::reliable;
  if (!is_known(flags & 7) || (!has_payload && in.remaining() > 0))
    return errc::bad_value;
  x.payload = to_bytes(in.rest());
  return x;
}

} // namespace rubicon::transport
