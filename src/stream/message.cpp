#include "stream/message.hpp"

#include "core/codec.hpp"

namespace rubicon::stream {

namespace {

struct writer {
  byte_writer& to;

  void operator()(const open_message& x) const {
    to.octet(1).big(x.name);
    if (x.qos != 0)
      to.octet(x.qos);
  }
  void operator()(const open_ack_message& x) const { to.octet(2).big(x.name); }
  void operator()(const write_message& x) const { to.octet(3).big(x.sequence).append(x.record); }
  void operator()(const ack_message& x) const { to.octet(4).big(x.next); }
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
  if (from.ok() && (kind < 1 || kind > 4))
    return errc::unsupported;
  const auto number = from.big<std::uint16_t>();
  if (!from.ok())
    return errc::truncated;
  if (kind == 3)
    return message{write_message{number, to_bytes(from.rest())}};
  std::uint8_t qos = 0;
  if (kind == 1 && from.remaining() > 0 && (qos = from.octet()) == 0)
    return errc::bad_value;
  if (from.remaining() > 0)
    return errc::too_long;
  if (kind == 1)
    return message{open_message{number, qos}};
  return kind == 2 ? message{open_ack_message{number}} : message{ack_message{number}};
}

} // namespace rubicon::stream
