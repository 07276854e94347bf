#include "stream/message.hpp"

#include "core/codec.hpp"

namespace rubicon::stream {

namespace {

struct writer {
  byte_writer& to;

  void operator()(const open_message& x) const { to.octet(1).big(x.name); }
  void operator()(const open_ack_message& x) const { to.octet(2).big(x.name); }
  void operator()(const write_message& x) const { to.octet(3).big(x.sequence).append(x.record); }
};

} // namespace

bytes encode(const message& x) {
  byte_writer to;
  std::visit(writer{to}, x);
  return to.finish();
}

result<message> decode_message(byte_view octets) {
  byte_reader from(octets);
  const auto kind = from.octet();
  if (from.ok() && (kind < 1 || kind > 3))
    return errc::unsupported;
  const auto number = from.big<std::uint16_t>();
  if (!from.ok())
    return errc::truncated;
  if (kind == 3)
    return message{write_message{number, to_bytes(from.rest())}};
  if (from.remaining() > 0)
    return errc::too_long;
  return kind == 1 ? message{open_message{number}} : message{open_ack_message{number}};
}

} // namespace rubicon::stream
