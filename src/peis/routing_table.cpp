#include "peis/routing_table.hpp"

#include <utility>

namespace rubicon::peis {

namespace {

constexpr std::uint8_t lost_first = 250;
constexpr std::uint8_t lost_last = 254; // three periods later (RTE-07)

} // namespace

routing_changes routing_table::on_table(link_id link, std::uint8_t cost,
                                        std::span<const routing_entry> entries, instant now) {
  link_table fresh;
  for (const auto& entry : entries) {
    if (entry.id == self_) {
      note_own(entry);
    } else if (entry.id.value > 0 && entry.hops + cost < metric_limit_ && !buried(entry, now)) {
      fresh[entry.id] = {entry.seqno, entry.magic, static_cast<std::uint8_t>(entry.hops + cost),
                         entry.connections, link};
    }
  }
  by_link_[link] = std::move(fresh);
  const auto& table = by_link_[link];
  routing_changes changes;
  for (const auto& [host, offered] : table)
    merge(link, host, offered, changes);
  for (auto& [host, known] : routes_) {
    if (known.via == link && !table.contains(host))
      lose(host, known, changes);
  }
  return changes;
}

/// A neighbour may know an earlier incarnation of ours with a higher number, which would hide our
/// ways until we have caught up (peis-wire.md 9.6).
void routing_table::note_own(const routing_entry& entry) {
  if (entry.magic != magic_ && entry.seqno >= seqno_) {
    seqno_ = entry.seqno;
    overtaken_ = true;
  }
}

bool routing_table::take_overtaken() {
  return std::exchange(overtaken_, false);
}

bool routing_table::buried(const routing_entry& entry, instant now) {
  const auto grave = graves_.find(entry.id);
  if (grave == graves_.end())
    return false;
  if (grave->second.until <= now) {
    graves_.erase(grave);
    return false;
  }
  return grave->second.magic == entry.magic;
}

void routing_table::merge(link_id link, peer_id host, const route& offered,
                          routing_changes& changes) {
  const auto [at, is_new] = routes_.try_emplace(host, offered);
  auto& known = at->second;
  using kind = routing_change::kind;
  if (is_new) {
    changes.push_back({host, kind::appeared});
    return;
  }
  const bool better = known.lost() || offered.merit() > known.merit();
  if (known.via != link && !better)
    return;
  if (known.lost())
    changes.push_back({host, kind::appeared});
  else if (known.magic != offered.magic)
    changes.push_back({host, kind::reborn});
  known = offered;
}

void routing_table::lose(peer_id host, route& lost, routing_changes& changes) {
  const route* best = nullptr;
  for (const auto& [link, table] : by_link_) {
    const auto other = table.find(host);
    if (other != table.end() && link != lost.via &&
        (best == nullptr || other->second.merit() > best->merit()))
      best = &other->second;
  }
  if (best != nullptr) {
    lost = *best;
    changes.push_back({host, routing_change::kind::moved});
    return;
  }
  lost.via.reset();
  lost.hops = lost_first;
  changes.push_back({host, routing_change::kind::lost});
}

routing_changes routing_table::on_link_closed(link_id link) {
  by_link_.erase(link);
  routing_changes changes;
  for (auto& [host, known] : routes_) {
    if (known.via == link)
      lose(host, known, changes);
  }
  return changes;
}

std::vector<peer_id> routing_table::age(instant now) {
  std::erase_if(graves_, [now](const auto& grave) { return grave.second.until <= now; });
  std::vector<peer_id> outdated;
  for (auto& [host, known] : routes_) {
    if (known.lost() && ++known.hops >= lost_last)
      outdated.push_back(host);
  }
  return outdated;
}

void routing_table::erase(peer_id host) {
  routes_.erase(host);
  for (auto& [link, table] : by_link_)
    table.erase(host);
}

void routing_table::bury(peer_id host, std::int32_t magic, instant until) {
  graves_[host] = {magic, until};
}

const route* routing_table::find(peer_id host) const {
  const auto at = routes_.find(host);
  return at == routes_.end() ? nullptr : &at->second;
}

std::optional<link_id> routing_table::way_to(peer_id host) const {
  const auto* known = find(host);
  return known != nullptr ? known->via : std::nullopt;
}

std::vector<routing_entry> routing_table::table_for(link_id link, std::uint8_t connections) const {
  std::vector<routing_entry> entries;
  entries.reserve(routes_.size() + 1);
  entries.push_back({self_, seqno_, magic_, 0, connections});
  for (const auto& [host, known] : routes_) {
    if (known.via != link)
      entries.push_back({host, known.seqno, known.magic, known.hops, known.connections});
  }
  return entries;
}

} // namespace rubicon::peis
