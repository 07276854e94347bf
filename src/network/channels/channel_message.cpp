#include "network/channels/channel_message.hpp"

#include "core/codec.hpp"
#include "network/wire.hpp"

namespace rubicon::network {

namespace {

constexpr std::uint8_t flag_place = 1;
constexpr std::uint8_t flag_flooded = 2;

struct channel_writer {
  byte_writer& to;

  void operator()(const connect_message& x) const {
    const auto place = x.place.value_or(virtual_coordinates{});
    to.big(x.destination.value);
    to.octet(
        static_cast<std::uint8_t>((x.place ? flag_place : 0) | (x.flooded ? flag_flooded : 0)));
    to.octet(place.x).octet(place.y).octet(place.z).octet(x.hops).big(x.expiry_s);
    write(to, x.schedule.first);
    to.big(static_cast<std::uint32_t>(x.schedule.interval.count())).octet(x.schedule.size);
    to.big(x.delay_us);
  }
  void operator()(const connect_ack_message& x) const { to.octet(x.hops); }
  void operator()(const end_message& x) const { to.octet(static_cast<std::uint8_t>(x.why)); }
  void operator()(const dead_end_message&) const {}
  void operator()(const data_message& x) const { to.octet(x.sequence).append(x.content); }
};

connect_message read_connect(byte_reader& from) {
  connect_message x;
  x.destination = mote_id{from.big<std::uint16_t>()};
  const auto flags = from.octet();
  virtual_coordinates place;
  place.x = from.octet();
  place.y = from.octet();
  place.z = from.octet();
  if ((flags & flag_place) != 0)
    x.place = place;
  x.flooded = (flags & flag_flooded) != 0;
  x.hops = from.octet();
  x.expiry_s = from.big<std::uint16_t>();
  x.schedule.first = read_island_time(from);
  x.schedule.interval = std::chrono::milliseconds(from.big<std::uint32_t>());
  x.schedule.size = from.octet();
  x.delay_us = from.big<std::uint32_t>();
  return x;
}

} // namespace

std::string to_string(channel_id x) {
  return to_string(x.source) + '.' + std::to_string(x.number);
}

std::string to_string(channel_end x) {
  switch (x) {
  case channel_end::no_room:
    return "no_room";
  case channel_end::unreachable:
    return "unreachable";
  case channel_end::disconnected:
    return "disconnected";
  case channel_end::broken:
    return "broken";
  case channel_end::expired:
    return "expired";
  }
  return "unknown";
}

bytes encode(const channel_message& x) {
  byte_writer to(frame_payload_max);
  to.octet(static_cast<std::uint8_t>(x.content.index() + 1));
  to.big(x.channel.source.value).big(x.channel.number);
  std::visit(channel_writer{to}, x.content);
  return to.finish();
}

result<channel_message> decode_channel_message(byte_view octets) {
  byte_reader from(octets);
  const auto kind = from.octet();
  channel_message x;
  x.channel.source = mote_id{from.big<std::uint16_t>()};
  x.channel.number = from.big<std::uint16_t>();
  std::uint8_t why = 1;
  switch (kind) {
  case 1:
    x.content = read_connect(from);
    break;
  case 2:
    x.content = connect_ack_message{from.octet()};
    break;
  case 3:
    why = from.octet();
    x.content = end_message{static_cast<channel_end>(why)};
    break;
  case 4:
    x.content = dead_end_message{};
    break;
  case 5: {
    const auto sequence = from.octet();
    x.content = data_message{sequence, to_bytes(from.rest())};
    break;
  }
  default:
    return from.ok() ? errc::unsupported : errc::truncated;
  }
  if (!from.ok())
    return errc::truncated;
  if (kind != 5 && from.remaining() > 0)
    return errc::too_long;
  if (why < 1 || why > 5)
    return errc::bad_value;
  return x;
}

} // namespace rubicon::network
