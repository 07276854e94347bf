#include "peis/hosts/host_presence.hpp"

#include <utility>

#include "peis/wire/dead_host.hpp"

namespace rubicon::peis {

namespace {

/// A real kernel that has had no route to us for 30 s has forgotten our subscriptions (peis-wire.md
/// 9.5); what we miss of the time and it does not is less than half of it.
constexpr duration given_up_after = 15s;

} // namespace

/// Only reachability spreads at once: a mere change of preference would echo round every cycle.
void host_presence::apply(const routing_changes& changes, const occasion& x) {
  bool urgent = false;
  for (const auto& [host, what] : changes) {
    urgent = urgent || what != routing_change::kind::moved || on_.routes.routes().is_unsound(host);
    if (what == routing_change::kind::lost) {
      on_.inquiry.forget(host);
      on_.routes.forget_source(host);
      on_.hosts.note_lost(host, x.now);
    } else if (on_.hosts.knows_present(host)) {
      on_.inquiry.forget(host);
      welcome(host, x);
    } else {
      on_.inquiry.note_stranger(host, x.now);
    }
  }
  if (urgent)
    on_.exchange.trigger(x.now);
  else if (!changes.empty())
    on_.exchange.trigger_calmly(x.now);
  on_.tracer.probe_unsound(x.now);
  update_cluster(x);
}

void host_presence::welcome(peer_id id, const occasion& x) {
  auto* known = on_.hosts.find(id);
  if (known == nullptr || !on_.routes.reachable(id))
    return;
  if (known->record.marked)
    on_.routes.routes().mark(id);
  const auto lost = on_.hosts.note_found(*known);
  if (std::exchange(known->forgotten, false))
    notify_forgotten(id, x);
  if (known->announced) {
    if (lost && *lost + given_up_after <= x.now)
      x.out.push_back(forgotten_by{id});
    return;
  }
  on_.hosts.note_announced(*known);
  x.out.push_back(host_appeared{id, known->record.magic});
}

void host_presence::notify_forgotten(peer_id id, const occasion& x) {
  on_.messages.send(
      {id,
       port::dead_host,
       {encode(dead_host_message{on_.own.self.id, dead_host_message::reason::reborn}), {}},
       true,
       priority::high,
       no_request},
      x.origin, x.out);
}

void host_presence::forget(peer_id id, const occasion& x) {
  if (const auto* known = on_.hosts.find(id); known != nullptr && known->announced)
    x.out.push_back(host_vanished{id});
  on_.messages.on_host_gone(id, x.out);
  on_.inquiry.forget(id);
  on_.hosts.erase(id);
  on_.routes.forget_source(id);
  on_.traffic.forget(id);
  on_.tracer.end_probe(id);
}

void host_presence::note_elsewhere(peer_id host, const occasion& x) {
  if (!on_.hosts.note_elsewhere(host))
    return;
  on_.contacts.forget(host); // it is tried there at once
  x.out.push_back(namesake_found{host, on_.hosts.find(host)->record.full_name});
}

/// CLU-01, CLU-03.
void host_presence::update_cluster(const occasion& x) {
  auto& self = on_.own.self;
  auto lowest = self.id;
  for (const auto& [host, way] : on_.routes.routes().routes()) {
    if (host > lowest)
      break;
    if (!way.lost()) {
      lowest = host;
      break;
    }
  }
  if (std::exchange(self.cluster, lowest.value) != lowest.value)
    on_.announcements.announce_now(x);
}

} // namespace rubicon::peis
