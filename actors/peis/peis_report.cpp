// What a peer reports of itself.
#include <utility>

#include "actors/messages/supervision.hpp"
#include "actors/peis/peis_peer.hpp"

namespace rubicon {

namespace {

/// What limits have refused or put off (docs/security.md).
void add_limits(report::cause_counts& to, const peis::kernel_counters& counted) {
  const auto& x = counted.network;
  const auto& tuples = counted.tuples;
  const std::pair<const char*, std::uint64_t> all[] = {
      {"over_budget", x.rests},
      {"turns", x.held},
      {"fragments_refused", x.fragments_refused},
      {"greetings_evicted", x.greetings_evicted},
      {"hosts_refused", x.hosts_refused},
      {"newcomers_referred", x.newcomers_referred},
      {"questions_refused", x.questions_refused},
      {"routes_refused", x.routes_refused},
      {"rivals_refused", x.rivals_refused},
      {"claims_refused", x.claims_refused},
      {"tables_put_off", x.tables_put_off},
      {"tuples_full", tuples.overflow},
      {"tuples_malformed", tuples.malformed},
      {"subscriptions_full", tuples.subscribers_refused},
      {"strangers", tuples.strangers_refused},
      {"appends_refused", tuples.appends_refused},
      {"orphans", tuples.orphans_removed},
      {"stale_removed", tuples.stale_removed},
      {"resyncs", tuples.resyncs},
      {"pushes_given_up", tuples.pushes_given_up},
      {"values_overtaken", tuples.pushes_overtaken},
      {"announcements_foreign", x.announcements_foreign},
      {"absent_forgotten", tuples.absent_forgotten}};
  for (const auto& [name, count] : all) {
    if (count > 0)
      to[name] = count;
  }
}

} // namespace

report::cause_counts packages_lost(const peis_peer_state& x) {
  const auto counted = x.kernel.counters().network;
  return {{"queue_full", counted.queue_full},
          {"early_drop", counted.early_drop},
          {"no_route", counted.no_route},
          {"hops", counted.hops},
          {"queued_lost", counted.queued_lost},
          {"illegal", counted.illegal},
          {"malformed", counted.malformed},
          {"incomplete", counted.messages_incomplete},
          {"network", x.packages_lost},
          {"paused", x.held_lost},
          {"own_id", counted.own}};
}

void send_status(peer_pointer self) {
  const auto& state = self->state;
  const auto all_counted = state.kernel.counters();
  const auto& counted = all_counted.network;
  peer_status status;
  auto& peer = status.peer;
  peer.id = state.kernel.id();
  peer.name = state.arguments.name;
  peer.incarnations = state.arguments.incarnation + 1;
  peer.links = state.links.size() + state.tcp_links.size();
  peer.links_opened = counted.links_opened;
  peer.links_closed = state.links_closed;
  peer.attempts = counted.attempts;
  peer.attempts_failed = counted.attempts_failed;
  for (const auto* host : state.kernel.network().hosts.records()) {
    if (state.kernel.network().knows_present(host->id) ||
        !state.kernel.network().reachable(host->id))
      status.hosts.push_back(host->id);
    if (host->id == peer.id)
      peer.cluster = host->cluster;
  }
  for (const auto& link : state.kernel.network().links.views()) {
    if (link.neighbour)
      status.neighbours.push_back(*link.neighbour);
  }
  const auto time = state.kernel.reader().network_time(now(self));
  status.clock_offset = std::chrono::seconds(time.seconds) +
                        std::chrono::microseconds(time.microseconds) - now(self).time_since_epoch();
  peer.hosts_known = status.hosts.size();
  peer.tuples = state.kernel.reader().own().size();
  peer.peis.packages = counted.packages_sent;
  peer.peis.tuples = peer.tuples;
  peer.peis.lost = packages_lost(state);
  add_limits(peer.limits, all_counted);
  report::add_counters<peis::p2p_counters>(peer.counters, "network", counted);
  report::add_counters<peis::tuple_counters>(peer.counters, "tuples", all_counted.tuples);
  report::add_counters<peis::kernel_counters>(peer.counters, "kernel", all_counted);
  if (state.real != nullptr) {
    const auto at_links = state.real->links().counters();
    report::add_counters<peer::links_counters>(peer.counters, "tcp", at_links);
    if (const auto* udp = state.real->links().over_udp())
      report::add_counters<peis::udp_counters>(peer.counters, "udp", udp->counters());
    if (const auto* bluetooth = state.real->over_bluetooth())
      report::add_counters<peer::bluetooth_counters>(peer.counters, "bluetooth",
                                                     bluetooth->counters());
    if (at_links.refused > 0)
      peer.limits["connections_refused"] = at_links.refused;
    if (at_links.foreign > 0)
      peer.limits["connections_foreign"] = at_links.foreign;
  }
  self->send(state.arguments.ecology, std::move(status));
}

} // namespace rubicon
