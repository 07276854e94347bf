#include "mote/packet_service.hpp"

#include <algorithm>

#include "core/account/message_ledger.hpp"
#include "core/codec.hpp"
#include "network/am.hpp"

namespace rubicon::mote {

namespace {

/// What is carried begins with its AM type.
bytes content(std::uint8_t am_type, byte_view octets) {
  byte_writer out(1 + octets.size());
  out.big(am_type).append(octets);
  return out.finish();
}

void append(packet_service_outputs& to, packet_service_outputs from) {
  std::ranges::move(from, std::back_inserter(to));
}

/// Fragments of one packet may leave in one window and the next.
transport::assembly_config assembly_of(const network::router_config& config) {
  transport::assembly_config x;
  x.packets_max = config.is_sink ? 32 : 1;
  x.patience += 2 * config.duty.period;
  return x;
}

} // namespace

packet_service::packet_service(network::router_config config, random_stream rng, instant now)
    : router_(config, rng, now), fragments_(assembly_of(config)) {}

packet_service_outputs packet_service::send(mote_id to, const network::island_packet& x,
                                            instant now, bool in_slot) {
  const auto room = router_.room_to(to);
  const auto fragments = room ? transport::cut(encode(x), *room - 1, tag_++) : std::nullopt;
  if (!fragments) {
    ++counters_.unroutable;
    note_loss(loss::no_route);
    return {};
  }
  packet_service_outputs out;
  for (const auto& fragment : *fragments)
    append(out, carry(router_.send(to, content(network::am::packet, fragment), now, in_slot), now));
  return out;
}

packet_service_outputs packet_service::send_to_all(const network::island_packet& x, instant now) {
  packet_service_outputs out;
  const auto fragments = transport::cut(encode(x), network::room_to_all() - 1, tag_++);
  for (const auto& fragment : *fragments) // a flood's room does not vary: they always suffice
    append(out, carry(router_.send_to_all(content(network::am::packet, fragment), now), now));
  return out;
}

packet_service_outputs packet_service::send_management(mote_id to, byte_view message, instant now) {
  const auto room = router_.room_to(to);
  if (!room || message.size() + 1 > *room) {
    ++counters_.unroutable;
    return {};
  }
  return carry(router_.send(to, content(network::am::component_management, message), now), now);
}

packet_service_outputs packet_service::on_frame(mote_id source, std::uint8_t am_type,
                                                byte_view payload, instant sfd, instant now,
                                                network::medium over) {
  return carry(router_.on_frame(source, am_type, payload, sfd, now, over), now);
}

packet_service_outputs packet_service::on_sent(std::uint64_t token, bool acked,
                                               unsigned transmissions, instant now) {
  return carry(router_.on_sent(token, acked, transmissions, now), now);
}

packet_service_outputs packet_service::on_time(instant now) {
  return carry(router_.on_time(now), now);
}

packet_service_outputs packet_service::carry(network::router_outputs from_router, instant now) {
  packet_service_outputs out;
  for (auto& each : from_router) {
    std::visit(
        [&](auto& x) {
          if constexpr (std::is_same_v<std::decay_t<decltype(x)>, network::content_in>)
            take(std::move(x), out, now);
          else
            out.emplace_back(std::move(x));
        },
        each);
  }
  return out;
}

void packet_service::take(network::content_in x, packet_service_outputs& out, instant now) {
  const auto octets = byte_view(x.content);
  const auto origin = x.origin.value_or(router_.tree().root());
  if (!octets.empty() && octets[0] == network::am::component_management) {
    out.emplace_back(management_in{origin, to_bytes(octets.subspan(1))});
    return;
  }
  if (octets.empty() || octets[0] != network::am::packet) {
    ++counters_.malformed;
    note_loss(loss::malformed);
    return;
  }
  const auto whole = fragments_.on_fragment(origin, octets.subspan(1), now);
  if (!whole)
    return;
  auto packet = network::decode_island_packet(*whole);
  if (packet) {
    out.emplace_back(packet_in{x.origin, x.to_all, *std::move(packet)});
  } else {
    ++counters_.malformed;
    note_loss(loss::malformed);
  }
}

} // namespace rubicon::mote
