#include "peis/overlay/routing_table.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace rubicon::peis {

namespace {

constexpr std::size_t graves_max = 4096;
constexpr duration doubt_time = 30s;
constexpr std::uint8_t lost_first = 250;
constexpr std::int32_t seqno_believed_max = 1 << 30; // 17 years of two sendings a second
constexpr std::uint8_t lost_last = 253;              // after three periods (RTE-07)

/// Can the offered route not lead through us, given what the last route was?
bool is_sound(const route& last, std::uint8_t last_hops, const route& offered) {
  return offered.magic != last.magic || offered.seqno > last.seqno ||
         (offered.seqno == last.seqno && offered.neighbour_hops < last_hops);
}

/// Only who lives raises its number.
bool is_news(const route& last, const route& offered) {
  return offered.magic != last.magic || offered.seqno > last.seqno;
}

} // namespace

const route* routing_table::offer_in(const link_table& table, peer_id host) {
  const auto at = std::lower_bound(table.begin(), table.end(), host,
                                   [](const auto& x, peer_id id) { return x.first < id; });
  return at != table.end() && at->first == host ? &at->second : nullptr;
}

/// What is announced again is no news.
void routing_table::keep_age(link_table& fresh, const link_table& last) {
  auto old = last.begin();
  for (auto& [host, x] : fresh) {
    while (old != last.end() && old->first < host)
      ++old;
    if (old != last.end() && old->first == host && !is_news(old->second, x))
      x.news = old->second.news;
  }
}

void routing_table::erase_from(link_table& table, peer_id host) {
  const auto at = std::lower_bound(table.begin(), table.end(), host,
                                   [](const auto& x, peer_id id) { return x.first < id; });
  if (at != table.end() && at->first == host)
    table.erase(at);
}

routing_changes routing_table::on_table(link_id link, std::uint8_t cost,
                                        std::span<const routing_entry> entries, instant now) {
  link_table fresh;
  fresh.reserve(entries.size());
  for (const auto& entry : entries) {
    if (entry.id == self_) {
      note_own(entry);
    } else if (entry.id.value > 0 && entry.hops + cost < metric_limit_ && !buried(entry, now)) {
      fresh.emplace_back(entry.id, route{entry.seqno, entry.magic,
                                         static_cast<std::uint8_t>(entry.hops + cost),
                                         entry.connections, link, entry.hops, now});
    }
  }
  const auto by_host = [](const auto& a, const auto& b) { return a.first < b.first; };
  if (!std::is_sorted(fresh.begin(), fresh.end(), by_host))
    std::stable_sort(fresh.begin(), fresh.end(), by_host);
  fresh.erase(std::unique(fresh.begin(), fresh.end(),
                          [](const auto& a, const auto& b) { return a.first == b.first; }),
              fresh.end());
  auto& table = by_link_[link];
  keep_age(fresh, table);
  table = std::move(fresh);

  // Both are sorted: one walk finds new hosts, other routes, and routes that are announced no more.
  routing_changes changes;
  link_table added;
  auto room = room_for(link);
  auto known = routes_.begin();
  const auto pass = [&](peer_id until) {
    for (; known != routes_.end() && known->first < until; ++known) {
      if (known->second.via != link)
        continue;
      lose(known->first, known->second, now, changes);
      if (!known->second.lost() && marked_.contains(known->first))
        unsound_.insert(known->first); // others may have yet to lose it as well
    }
  };
  for (const auto& [host, offered] : table) {
    pass(host);
    if (is_in_doubt(host, offered)) {
      if (offered.news == now)
        unsound_.insert(host);
      continue; // and its present route, if any, is one to another incarnation
    }
    if (known == routes_.end() || known->first != host) {
      if (room == 0) {
        ++refused_;
        continue;
      }
      --room;
      added.emplace_back(host, offered);
      end_doubt(host, offered);
      changes.push_back({host, routing_change::kind::appeared});
    } else {
      merge(link, host, known->second, offered, changes);
      ++known;
    }
  }
  pass(peer_id{std::numeric_limits<std::int32_t>::max()});
  for (const auto& [host, offered] : added)
    routes_.emplace(host, offered);
  return changes;
}

/// How many more hosts this link may bring: as many as it has routes to, at most, are free. Routes
/// that are lost make room.
std::size_t routing_table::room_for(link_id link) {
  const auto unlimited = std::numeric_limits<std::size_t>::max();
  if (routes_max_ == unlimited || routes_.size() + by_link_[link].size() < routes_max_ / 2)
    return unlimited;
  std::vector<peer_id> lost;
  std::size_t held = 0;
  for (const auto& [host, known] : routes_) {
    held += known.via == link ? 1 : 0;
    if (known.lost() && !marked_.contains(host))
      lost.push_back(host);
  }
  for (const auto host : lost) {
    routes_.erase(host);
    unsound_.erase(host);
  }
  evicted_.insert(evicted_.end(), lost.begin(), lost.end());
  const auto free = routes_max_ - std::min(routes_max_, routes_.size());
  return free > held ? (free - held) / 2 : 0;
}

/// A neighbour may know an earlier incarnation of ours with a higher number, which would hide our
/// routes until we have caught up (docs/peis-wire.md 9.6).
void routing_table::note_own(const routing_entry& entry) {
  if (entry.magic != magic_ && entry.seqno >= seqno_ && entry.seqno <= seqno_believed_max) {
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
  return grave->second.magic == entry.magic && entry.seqno <= grave->second.seqno;
}

void routing_table::merge(link_id link, peer_id host, route& known, const route& offered,
                          routing_changes& changes) {
  using kind = routing_change::kind;
  const bool better = known.lost() || offered.merit() > known.merit();
  if (known.via != link && !better)
    return;
  if (known.lost())
    changes.push_back({host, kind::appeared});
  else if (known.magic != offered.magic)
    changes.push_back({host, kind::reborn});
  else if (known.via == link && offered.hops > known.hops && marked_.contains(host)) {
    // The neighbour has had to take a longer route; perhaps, with a newer number, that of others
    // who have yet to learn that the host is gone.
    if (!is_sound(known, known.hops, offered))
      changes.push_back({host, kind::moved});
    unsound_.insert(host);
  }
  take(host, known, offered);
}

/// Takes a route in place of the one that is, or was, there.
void routing_table::take(peer_id host, route& known, const route& offered) {
  const auto last_hops = known.lost() ? known.neighbour_hops : known.hops;
  const bool worse = known.lost() || offered.hops > known.hops;
  if (worse && !is_sound(known, last_hops, offered))
    unsound_.insert(host);
  const auto received = known.news;
  const bool news = is_news(known, offered);
  known = offered;
  if (!news)
    known.news = std::min(received, offered.news);
  forget_loss(host);
  end_doubt(host, offered);
}

const route* routing_table::best_offer(peer_id host, std::optional<link_id> but) const {
  const route* best = nullptr;
  for (const auto& [link, table] : by_link_) {
    const auto* offered = link == but ? nullptr : offer_in(table, host);
    if (offered != nullptr && (best == nullptr || offered->merit() > best->merit()))
      best = offered;
  }
  return best;
}

void routing_table::lose(peer_id host, route& lost, instant now, routing_changes& changes) {
  const auto* best = best_offer(host, lost.via);
  if (best == nullptr || is_in_doubt(host, *best)) {
    let_go(host, lost, now, changes);
    return;
  }
  take(host, lost, *best);
  changes.push_back({host, routing_change::kind::moved});
}

void routing_table::let_go(peer_id host, route& lost, instant now, routing_changes& changes) {
  lost.via.reset();
  lost.neighbour_hops = lost.hops; // what soundness is measured against
  lost.hops = lost_first;
  unsound_.erase(host);
  if (marked_.contains(host)) {
    note_loss(host, now);
    dig(host, {lost.magic, std::numeric_limits<std::int32_t>::min(), now + doubt_time, true});
  }
  changes.push_back({host, routing_change::kind::lost});
}

routing_changes routing_table::on_link_closed(link_id link, instant now) {
  by_link_.erase(link);
  routing_changes changes;
  for (auto& [host, known] : routes_) {
    if (known.via == link)
      lose(host, known, now, changes);
  }
  return changes;
}

routing_changes routing_table::on_heard(link_id link, peer_id host, std::int32_t magic,
                                        std::uint8_t hops, instant now) {
  const auto at = routes_.find(host);
  const bool known = at != routes_.end();
  if (hops >= metric_limit_ || (known && !at->second.lost()) || (!known && room_for(link) == 0))
    return {};
  route offered{0, magic, hops, connections_unknown, link, hops, now};
  if (known) {
    offered.seqno = at->second.magic == magic ? at->second.seqno : 0;
    take(host, at->second, offered);
  } else {
    routes_.emplace(host, offered);
    end_doubt(host, offered);
    if (marked_.contains(host))
      unsound_.insert(host);
  }
  return {{host, routing_change::kind::appeared}};
}

void routing_table::mark(peer_id host) {
  marked_.insert(host);
}

routing_changes routing_table::unanswered(peer_id host, instant since, instant until) {
  routing_changes changes;
  const auto at = routes_.find(host);
  const bool known = at != routes_.end() && !at->second.lost();
  const auto grave = graves_.find(host);
  if (!known && (grave == graves_.end() || !grave->second.proof))
    return changes;
  burial silent = known ? burial{at->second.magic, at->second.seqno, until, marked_.contains(host)}
                        : grave->second;
  silent.until = until;
  for (auto& [link, table] : by_link_) {
    if (const auto* other = offer_in(table, host)) {
      silent.seqno = std::max(silent.seqno, other->seqno);
      erase_from(table, host);
    }
  }
  if (known) {
    let_go(host, at->second, since, changes);
  } else if (const auto lost = lost_at_.find(host);
             lost != lost_at_.end() && since < lost->second) {
    forget_loss(host); // lost while it was being probed
    note_loss(host, since);
  }
  graves_[host] = silent;
  return changes;
}

routing_changes routing_table::on_sign_of_life(peer_id host) {
  if (graves_.empty())
    return {};
  const auto* best = best_offer(host, std::nullopt);
  if (best == nullptr || !is_in_doubt(host, *best))
    return {};
  const auto offered = *best;
  const auto at = routes_.find(host);
  if (at == routes_.end()) {
    if (room_for(*offered.via) == 0)
      return {};
    routes_.emplace(host, offered);
    end_doubt(host, offered);
  } else {
    if (!at->second.lost())
      return {}; // another incarnation
    take(host, at->second, offered);
  }
  unsound_.erase(host);
  return {{host, routing_change::kind::appeared}};
}

std::vector<link_id> routing_table::offers_of(peer_id host) const {
  std::vector<std::pair<std::int64_t, link_id>> found;
  for (const auto& [link, table] : by_link_) {
    if (const auto* offered = offer_in(table, host))
      found.emplace_back(-offered->merit(), link);
  }
  std::ranges::sort(found);
  std::vector<link_id> links;
  for (const auto& [merit, link] : found)
    links.push_back(link);
  return links;
}

/// The neighbour itself needs no proof.
bool routing_table::is_in_doubt(peer_id host, const route& offered) const {
  return offered.neighbour_hops != 0 && needs_proof(host, offered);
}

bool routing_table::needs_proof(peer_id host, const route& offered) const {
  const auto grave = graves_.find(host);
  return grave != graves_.end() && grave->second.proof && grave->second.magic == offered.magic;
}

void routing_table::end_doubt(peer_id host, const route& offered) {
  if (needs_proof(host, offered))
    graves_.erase(host);
}

std::vector<peer_id> routing_table::age(instant now) {
  std::erase_if(graves_, [now](const auto& grave) { return grave.second.until <= now; });
  std::vector<peer_id> outdated;
  for (auto& [host, known] : routes_) {
    if (known.lost() && !lost_at_.contains(host) && ++known.hops >= lost_last)
      outdated.push_back(host);
  }
  return outdated;
}

std::vector<peer_id> routing_table::lost_since(instant then) const {
  std::vector<peer_id> hosts;
  for (const auto& [host, when] : lost_at_) {
    if (when <= then)
      hosts.push_back(host);
  }
  return hosts;
}

std::optional<instant> routing_table::first_loss() const {
  return losses_.empty() ? std::nullopt : std::optional(losses_.begin()->first);
}

void routing_table::note_loss(peer_id host, instant now) {
  if (lost_at_.try_emplace(host, now).second)
    losses_.emplace(now, host);
}

void routing_table::forget_loss(peer_id host) {
  const auto lost = lost_at_.find(host);
  if (lost == lost_at_.end())
    return;
  losses_.erase({lost->second, host});
  lost_at_.erase(lost);
}

void routing_table::erase(peer_id host) {
  routes_.erase(host);
  marked_.erase(host);
  unsound_.erase(host);
  forget_loss(host);
  for (auto& [link, table] : by_link_)
    erase_from(table, host);
}

void routing_table::bury(peer_id host, std::int32_t magic, instant until) {
  dig(host, {magic, std::numeric_limits<std::int32_t>::max(), until});
}

void routing_table::dig(peer_id host, const burial& grave) {
  if (graves_.size() >= graves_max && !graves_.contains(host))
    graves_.erase(
        std::ranges::min_element(graves_, {}, [](const auto& x) { return x.second.until; }));
  graves_[host] = grave;
}

void routing_table::distrust(peer_id host, std::int32_t magic, instant until) {
  std::optional<std::int32_t> newest;
  const auto consider = [&](const route* x) {
    if (x != nullptr && x->magic == magic)
      newest = std::max(newest.value_or(x->seqno), x->seqno);
  };
  consider(find(host));
  for (const auto& [link, table] : by_link_)
    consider(offer_in(table, host));
  dig(host, {magic, newest.value_or(std::numeric_limits<std::int32_t>::max()), until});
}

const route* routing_table::find(peer_id host) const {
  const auto at = routes_.find(host);
  return at == routes_.end() ? nullptr : &at->second;
}

std::optional<link_id> routing_table::way_to(peer_id host) const {
  const auto* known = find(host);
  return known != nullptr ? known->via : std::nullopt;
}

std::optional<unsigned> routing_table::loss_without(link_id link) const {
  unsigned worst = 0;
  for (const auto& [host, known] : routes_) {
    if (known.via != link)
      continue;
    std::optional<unsigned> best;
    for (const auto& [other, table] : by_link_) {
      const auto* offered = other == link ? nullptr : offer_in(table, host);
      if (offered != nullptr)
        best = std::min<unsigned>(best.value_or(offered->hops), offered->hops);
    }
    if (!best)
      return std::nullopt;
    worst = std::max(worst, std::max<unsigned>(*best, known.hops) - known.hops);
  }
  return worst;
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
