#include "actors/island/smepp_shell.hpp"

#include "actors/island/network_radio.hpp"
#include "actors/messages/air.hpp"
#include "actors/messages/supervision.hpp"
#include "network/am.hpp"

namespace rubicon {

radio_send request_of(radio::radio_index radio, smepp::send_frame x) {
  const bool unicast = x.to != broadcast_mote;
  return {radio,
          smepp_token | x.id,
          x.to,
          network::am::smepp,
          payload(std::move(x.octets)),
          unicast,
          no_age,
          false};
}

std::optional<std::uint64_t> smepp_id_of(const radio_done& x) {
  if ((x.token & network_token) != 0 || (x.token & smepp_token) == 0)
    return std::nullopt;
  return x.token & ~smepp_token;
}

smepp_status status_of(island_id island, const smepp::node& x, life_state state) {
  const bool ended = state != life_state::goes_on;
  const auto& peer = x.own();
  const auto& events = peer.events().counters();
  smepp_status status{island, {}};
  auto& r = status.smepp;
  for (const auto& each : x.members()) {
    const auto& program = each.counters();
    r.programs += state == life_state::replaced ? 0 : 1;
    r.members += each.group() && !ended ? 1 : 0;
    r.joins += program.joins;
    r.joins_failed += program.joins_failed;
    r.commands_failed += program.refused;
    report::add_counters<smepp::member_counters>(r.counters, "member", program);
  }
  r.frames = peer.counters().frames_sent;
  r.octets = peer.counters().octets_sent;
  r.events_raised = events.raised;
  r.events_suppressed = events.suppressed;
  r.events_received = events.received;
  r.events_lost = events.dropped;
  if (const auto waiting = peer.events().waiting_events(); ended && waiting > 0)
    r.events_lost["power_lost"] += waiting;
  else
    r.events_open = waiting;
  r.refused = peer.keys().counters().refused;
  r.state_octets = peer.footprint();
  report::add_counters<smepp::event_counters>(r.counters, "events", events);
  report::add_counters<smepp::group_counters>(r.counters, "groups", peer.groups().counters());
  report::add_counters<smepp::peer_counters>(r.counters, "peer", peer.counters());
  report::add_counters<smepp::security_counters>(r.counters, "security", peer.keys().counters());
  return status;
}

} // namespace rubicon
