#include "stream/message.hpp"

#include "core/codec.hpp"

namespace rubicon::stream {

namespace {

struct writer {
  byte_writer& to;

  void operator()(const open_message& x) const {
    to.octet(1).big(x.name);
    const bool goes_on = x.sequence != 0 || !x.recent.empty();
    if (x.qos != 0 || goes_on)
      to.octet(x.qos);
    if (goes_on)
      to.big(x.sequence);
    for (const auto& record : x.recent)
      to.octet(static_cast<std::uint8_t>(record.size())).append(record);
  }
  void operator()(const open_ack_message& x) const { to.octet(2).big(x.name); }
  void operator()(const write_message& x) const { to.octet(3).big(x.sequence).append(x.record); }
  void operator()(const ack_message& x) const { to.octet(4).big(x.next); }
};

/// What follows SS_OPEN's name.
/// @returns false if something is said that might have been left out
bool read_open(byte_reader& from, open_message& x) {
  const bool has_qos = from.remaining() > 0;
  if (has_qos)
    x.qos = from.octet();
  const bool goes_on = from.remaining() > 0;
  if (goes_on)
    x.sequence = from.big<std::uint16_t>();
  while (from.ok() && from.remaining() > 0) {
    const std::size_t size = from.octet();
    x.recent.push_back(to_bytes(from.take(size)));
  }
  return goes_on ? x.sequence != 0 || !x.recent.empty() : !has_qos || x.qos != 0;
}

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
  message x;
  bool is_sound = true;
  if (kind == 1)
    is_sound = read_open(from, x.emplace<open_message>(open_message{number}));
  else if (kind == 2)
    x.emplace<open_ack_message>(open_ack_message{number});
  else if (kind == 3)
    x.emplace<write_message>(write_message{number, to_bytes(from.rest())});
  else
    x.emplace<ack_message>(ack_message{number});
  if (!from.ok())
    return errc::truncated;
  if (from.remaining() > 0)
    return errc::too_long;
  if (!is_sound)
    return errc::bad_value;
  return x;
}

} // namespace rubicon::stream
