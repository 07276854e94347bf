#include "mote/join/management.hpp"

#include "core/codec.hpp"

namespace rubicon::mote {

namespace {

constexpr std::uint8_t battery_low_flag = 0x01;
constexpr std::uint8_t links_weak_flag = 0x02;

struct encoder {
  byte_writer& out;

  void operator()(const join_request& x) const {
    out.octet(1).big(x.sequence).big(x.incarnation).append(x.descriptor);
  }
  void operator()(const join_reply& x) const {
    out.octet(2).big(x.sequence).big(x.island.value).big(x.mote.value).big(x.time_ms);
    for (const auto alias : x.aliases)
      out.octet(static_cast<std::uint8_t>(alias.value));
  }
  void operator()(const join_confirm& x) const {
    out.octet(3).big(x.sequence).big(x.incarnation).append(x.descriptor);
  }
  void operator()(const leave_notice&) const { out.octet(4); }
  void operator()(const keep_alive& x) const {
    const auto flags = (x.condition.battery_low ? battery_low_flag : 0U) |
                       (x.condition.links_weak ? links_weak_flag : 0U);
    out.octet(5).big(x.incarnation).octet(static_cast<std::uint8_t>(flags));
    if (x.device != 0)
      out.big(x.device);
  }
  void operator()(const rejoin_prompt&) const { out.octet(6); }
  void operator()(const slot_notice& x) const {
    out.octet(7).big(x.units);
    write(x.slot);
  }
  void operator()(const join_refusal& x) const { out.octet(8).big(x.sequence); }
  void operator()(const slot_grant& x) const {
    out.octet(9);
    write(x.slot);
  }

  void write(const network::slot_run& x) const { out.big(x.first).big(x.units); }
};

/// A join_request or a join_confirm, which have the same layout.
template <class Message>
Message read_with_descriptor(byte_reader& in) {
  Message x;
  x.sequence = in.big<std::uint16_t>();
  x.incarnation = in.big<std::uint32_t>();
  if (in.ok())
    x.descriptor = to_bytes(in.rest());
  return x;
}

join_reply read_reply(byte_reader& in) {
  join_reply x;
  x.sequence = in.big<std::uint16_t>();
  x.island = island_id{in.big<std::uint32_t>()};
  x.mote = mote_id{in.big<std::uint16_t>()};
  x.time_ms = in.big<std::uint32_t>();
  while (in.ok() && in.remaining() > 0 && x.aliases.size() < aliases_max)
    x.aliases.emplace_back(in.octet());
  return x;
}

network::slot_run read_slot(byte_reader& in) {
  const auto first = in.big<std::uint16_t>();
  return {first, in.big<std::uint16_t>()};
}

slot_notice read_notice(byte_reader& in) {
  const auto units = in.big<std::uint16_t>();
  return {units, read_slot(in)};
}

/// @param is_sound false if a flag is unknown, or the device's number is there and 0
keep_alive read_keep_alive(byte_reader& in, bool& is_sound) {
  keep_alive x;
  x.incarnation = in.big<std::uint32_t>();
  const auto flags = in.octet();
  x.condition = {(flags & battery_low_flag) != 0, (flags & links_weak_flag) != 0};
  is_sound = (flags & ~(battery_low_flag | links_weak_flag)) == 0;
  if (in.remaining() > 0) {
    x.device = in.big<std::uint32_t>();
    is_sound = is_sound && x.device != 0;
  }
  return x;
}

} // namespace

bytes encode(const management& x) {
  byte_writer out;
  std::visit(encoder{out}, x);
  return out.finish();
}

result<management> decode_management(byte_view octets) {
  byte_reader in(octets);
  management x;
  bool is_sound = true;
  switch (in.octet()) {
  case 1:
    x = read_with_descriptor<join_request>(in);
    break;
  case 2:
    x = read_reply(in);
    break;
  case 3:
    x = read_with_descriptor<join_confirm>(in);
    break;
  case 4:
    x = leave_notice{};
    break;
  case 5:
    x = read_keep_alive(in, is_sound);
    break;
  case 6:
    x = rejoin_prompt{};
    break;
  case 7:
    x = read_notice(in);
    break;
  case 8:
    x = join_refusal{in.big<std::uint16_t>()};
    break;
  case 9:
    x = slot_grant{read_slot(in)};
    break;
  default:
    return in.ok() ? errc::unsupported : errc::truncated;
  }
  if (!in.ok())
    return errc::truncated;
  if (in.remaining() > 0)
    return errc::too_long;
  if (!is_sound)
    return errc::bad_value;
  return x;
}

} // namespace rubicon::mote
