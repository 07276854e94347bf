#include "serial/raw_packet.hpp"

#include <cassert>

#include "core/codec.hpp"

namespace rubicon::serial {

namespace {

constexpr std::size_t fcs_octets = 2;
constexpr std::size_t shortest = 5; // an acknowledgement

// Of the frame control field.
constexpr std::uint16_t kind_mask = 0x0007;
constexpr std::uint16_t secured_bit = 0x0008;
constexpr std::uint16_t pending_bit = 0x0010;
constexpr std::uint16_t ack_bit = 0x0020;
constexpr std::uint16_t one_pan_bit = 0x0040;
constexpr unsigned destination_shift = 10;
constexpr unsigned source_shift = 14;
constexpr std::uint16_t tinyos_data = 0x8841; // short addresses in one PAN

// Addressing modes.
constexpr unsigned mode_mask = 3;
constexpr unsigned mode_none = 0;
constexpr unsigned mode_reserved = 1;
constexpr unsigned mode_long = 3;

raw_end read_end(byte_reader& in, unsigned mode, bool has_pan) {
  raw_end x;
  if (mode == mode_none)
    return x;
  if (has_pan)
    x.pan = in.little<std::uint16_t>();
  x.is_long = mode == mode_long;
  x.address = x.is_long ? in.little<std::uint64_t>() : in.little<std::uint16_t>();
  return x;
}

} // namespace

std::string_view to_string(raw_kind x) {
  switch (x) {
  case raw_kind::beacon:
    return "beacon";
  case raw_kind::data:
    return "data";
  case raw_kind::ack:
    return "ack";
  case raw_kind::command:
    return "command";
  }
  return "?";
}

result<raw_frame> decode_raw_packet(byte_view packet) {
  byte_reader in(packet);
  const auto dispatch = in.octet();
  const std::size_t length = in.octet();
  if (!packet.empty() && dispatch != raw_dispatch)
    return errc::unsupported;
  if (!in.ok())
    return errc::truncated;
  if (length > raw_length_max)
    return errc::too_long;
  if (length < shortest)
    return errc::bad_value;
  if (in.remaining() != length - fcs_octets)
    return in.remaining() > length - fcs_octets ? errc::too_long : errc::truncated;
  const auto control = in.little<std::uint16_t>();
  const unsigned destination_mode = control >> destination_shift & mode_mask;
  const unsigned source_mode = control >> source_shift & mode_mask;
  const unsigned kind = control & kind_mask;
  if (kind > static_cast<unsigned>(raw_kind::command) || destination_mode == mode_reserved ||
      source_mode == mode_reserved)
    return errc::bad_value;
  raw_frame x;
  x.kind = static_cast<raw_kind>(kind);
  x.is_secured = (control & secured_bit) != 0;
  x.is_pending = (control & pending_bit) != 0;
  x.asks_ack = (control & ack_bit) != 0;
  x.sequence = in.octet();
  x.destination = read_end(in, destination_mode, true);
  x.source = read_end(in, source_mode, (control & one_pan_bit) == 0);
  if (!in.ok())
    return errc::truncated;
  x.body = to_bytes(in.rest());
  return x;
}

bytes wrap_raw(byte_view frame) {
  assert(frame.size() + fcs_octets <= raw_length_max);
  byte_writer out;
  out.octet(raw_dispatch).octet(static_cast<std::uint8_t>(frame.size() + fcs_octets));
  return out.append(frame).finish();
}

std::optional<am_packet> am_packet_in(const raw_frame& x) {
  constexpr std::size_t headers = 2; // network octet, AM type
  const auto is_short = [](const raw_end& end) { return end.address && !end.is_long; };
  if (x.kind != raw_kind::data || x.is_secured || !is_short(x.destination) || !is_short(x.source) ||
      x.body.size() < headers || x.body.front() != tinyos_network ||
      x.body.size() - headers > am_payload_max)
    return std::nullopt;
  byte_reader in(x.body);
  static_cast<void>(in.octet());
  am_packet out;
  out.destination = static_cast<std::uint16_t>(*x.destination.address);
  out.source = static_cast<std::uint16_t>(*x.source.address);
  out.group = static_cast<std::uint8_t>(*x.destination.pan & 0xff);
  out.am_type = in.octet();
  out.payload = to_bytes(in.rest());
  return out;
}

result<am_packet> decode_any_packet(byte_view packet) {
  if (!packet.empty() && packet.front() == cc1000_dispatch) { // the header is the same
    auto same = to_bytes(packet);
    same.front() = am_dispatch;
    return decode_am_packet(same);
  }
  if (packet.empty() || packet.front() != raw_dispatch)
    return decode_am_packet(packet);
  const auto frame = decode_raw_packet(packet);
  if (!frame)
    return frame.error();
  auto found = am_packet_in(*frame);
  if (!found)
    return errc::unsupported;
  return *std::move(found);
}

bytes encode_raw(const am_packet& x, std::uint8_t sequence) {
  assert(x.payload.size() <= am_payload_max);
  constexpr std::size_t headers = 11; // frame control to AM type
  byte_writer out;
  out.octet(raw_dispatch);
  out.octet(static_cast<std::uint8_t>(headers + x.payload.size() + fcs_octets));
  out.little(tinyos_data).octet(sequence).little(std::uint16_t{x.group});
  out.little(x.destination).little(x.source).octet(tinyos_network).octet(x.am_type);
  return out.append(x.payload).finish();
}

} // namespace rubicon::serial
