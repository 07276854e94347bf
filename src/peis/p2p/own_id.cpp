#include "peis/p2p/own_id.hpp"

#include <set>
#include <utility>
#include <variant>
#include <vector>

#include "peis/wire/dead_host.hpp"

namespace rubicon::peis {

void own_id::note_duplicate(const host_record& other, const occasion& x) {
  ++on_.own.counters.duplicate_id;
  apply(on_.rivalry.note(other, x.now), x);
}

void own_id::on_time(const occasion& x) {
  apply(on_.rivalry.on_time(x.now), x);
}

void own_id::on_package(link_id from, const package_header& header, byte_view data,
                        const occasion& x) {
  if (header.type != package_type::link || header.port != port::host_record)
    return;
  const auto message = decode_host_record_message(data);
  if (!message || message->record.id != on_.own.self.id)
    return;
  auto& link = on_.links.at(from);
  link.rivals = true;
  if (message->record.magic != on_.own.self.magic)
    return note_duplicate(message->record, x);
  if (link.tried_here && link.tried_for) {
    on_.presence.note_elsewhere(*link.tried_for, x); // we have called ourselves
    on_.closer.close(from, close_cause::own_id, x);
  }
}

void own_id::apply(id_rivalry::outputs todo, const occasion& x) {
  for (auto& each : todo) {
    if (auto* taken = std::get_if<id_taken>(&each)) {
      const bool leaves = taken->stays_away > duration(0);
      x.out.emplace_back(std::move(*taken));
      if (leaves)
        vacate(x);
    } else {
      on_.exchange.restart_period(x.now); // our id is ours again
    }
  }
}

/// Keeps off the network, without a message of exit: that would be taken for the other's.
void own_id::vacate(const occasion& x) {
  ++on_.own.counters.ids_yielded;
  std::vector<link_id> links;
  for (const auto& [link, each] : on_.links.all())
    links.push_back(link);
  for (const auto link : links)
    on_.closer.close(link, close_cause::own_id, x);
  on_.dials.abandon();
  std::set<peer_id> known;
  for (const auto& [id, each] : on_.hosts.all())
    known.insert(id);
  for (const auto& [id, way] : on_.routes.routes().routes())
    known.insert(id);
  for (const auto id : known)
    on_.removal.remove(id, dead_host_message::reason::route, x);
  on_.exchange.cancel();
}

} // namespace rubicon::peis
