#include "network/router_message.hpp"

#include "core/codec.hpp"

namespace rubicon::network {

namespace {

/// Three octets; none at all are known: 255 each.
void write_place(byte_writer& to, std::optional<virtual_coordinates> x) {
  const auto place = x.value_or(virtual_coordinates{hops_unknown, hops_unknown, hops_unknown});
  to.octet(place.x).octet(place.y).octet(place.z);
}

std::optional<virtual_coordinates> read_place(byte_reader& from) {
  virtual_coordinates place;
  place.x = from.octet();
  place.y = from.octet();
  place.z = from.octet();
  return place.x == hops_unknown ? std::nullopt : std::optional(place);
}

struct message_writer {
  byte_writer& to;

  void operator()(const user_content& x) const { to.append(x.content); }
  void operator()(const place_report& x) const { write_place(to, x.place); }
  void operator()(const place_question& x) const { to.big(x.mote.value); }
  void operator()(const place_answer& x) const {
    to.big(x.mote.value);
    write_place(to, x.place);
  }
  void operator()(const sequence_request&) const {}
  void operator()(const period_request& x) const { to.big(x.period.count()); }
};

} // namespace

bytes encode(const router_message& x) {
  byte_writer to(frame_payload_max);
  to.octet(static_cast<std::uint8_t>(x.index()));
  std::visit(message_writer{to}, x);
  return to.finish();
}

result<router_message> decode_router_message(byte_view octets) {
  byte_reader from(octets);
  const auto kind = from.octet();
  router_message x;
  switch (kind) {
  case 0:
    x = user_content{to_bytes(from.rest())};
    break;
  case 1:
    x = place_report{read_place(from)};
    break;
  case 2:
    x = place_question{mote_id{from.big<std::uint16_t>()}};
    break;
  case 3: {
    const mote_id mote{from.big<std::uint16_t>()};
    x = place_answer{mote, read_place(from)};
    break;
  }
  case 4:
    x = sequence_request{};
    break;
  case 5:
    x = period_request{std::chrono::duration<std::uint16_t>(from.big<std::uint16_t>())};
    break;
  default:
    return from.ok() ? errc::unsupported : errc::truncated;
  }
  if (!from.ok())
    return errc::truncated;
  if (kind != 0 && from.remaining() > 0)
    return errc::too_long;
  return x;
}

} // namespace rubicon::network
