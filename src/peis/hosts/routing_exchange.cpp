#include "peis/hosts/routing_exchange.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace rubicon::peis {

namespace {

constexpr std::size_t entries_per_work = 8;
constexpr std::size_t connections_max = 254; // 255 means unknown

/// Numbers newer than those of the frozen table stay as they are there.
void hold_back(std::vector<routing_entry>& entries, const std::vector<routing_entry>& frozen) {
  for (auto& x : entries) {
    const auto old = std::ranges::lower_bound(frozen, x.id, {}, &routing_entry::id);
    if (old != frozen.end() && old->id == x.id && old->magic == x.magic)
      x.seqno = std::min(x.seqno, old->seqno);
  }
}

} // namespace

routing_exchange::routing_exchange(own_peer& own, link_table& links, overlay& known,
                                   package_sender& sender, instant now)
    : own_(own), links_(links), overlay_(known), sender_(sender),
      rate_(own.config.tables.routing_work_per_second, 1s, 2s),
      next_period_(now + own.rng.between(own.config.routing_period / 2, own.config.routing_period)),
      last_trigger_(now - own.config.trigger_gap) {}

instant routing_exchange::may_apply_at(const connection& x) const {
  return std::max(x.routes.table_rate.free_at(), rate_.free_at());
}

bool routing_exchange::on_page(connection& from, byte_view data, instant now) {
  auto page = decode_routing_page(data);
  if (!page) {
    ++own_.counters.malformed;
    return false;
  }
  auto& collection = from.routes.pages;
  if (collection.seqno != page->seqno || collection.pages.size() != page->pages) {
    collection.seqno = page->seqno;
    collection.pages.assign(page->pages, std::nullopt);
  }
  collection.pages[page->page] = std::move(*page);
  std::vector<routing_entry> entries;
  for (const auto& part : collection.pages) {
    if (!part)
      return false;
    entries.insert(entries.end(), part->entries.begin(), part->entries.end());
  }
  collection.pages.clear();
  from.routes.drained = std::ranges::any_of(entries, [&](const routing_entry& x) {
    return x.id == from.neighbour && x.seqno < collection.seqno;
  });
  from.routes.table = std::move(entries);
  const auto due = may_apply_at(from);
  if (due <= now)
    return true;
  ++own_.counters.tables_put_off;
  next_tables_ = earliest(next_tables_, due);
  return false;
}

std::vector<link_id> routing_exchange::take_waiting(instant now) {
  if (!next_tables_ || now < *next_tables_)
    return {};
  next_tables_.reset();
  std::vector<link_id> waiting;
  for (const auto& [link, x] : links_.all()) {
    if (x.routes.table)
      waiting.push_back(link);
  }
  const auto first = std::ranges::upper_bound(waiting, last_table_);
  std::rotate(waiting.begin(), first, waiting.end());
  return waiting;
}

bool routing_exchange::may_apply(link_id link, instant now) {
  const auto* x = links_.find(link);
  if (x == nullptr || !x->routes.table)
    return false;
  const auto due = may_apply_at(*x);
  if (due > now) {
    next_tables_ = earliest(next_tables_, due);
    return false;
  }
  last_table_ = link;
  return true;
}

/// What a table costs is not for its neighbour alone to pay: it may send the same, in which all
/// changes, again and again. The newest is applied when its time has come.
routing_changes routing_exchange::apply(connection& from, instant now) {
  auto entries = std::move(*std::exchange(from.routes.table, std::nullopt));
  if (const auto drained = drains_.find(from.id); drained != drains_.end())
    hold_back(entries, drained->second.frozen);
  from.routes.table_rate.take(1, now);
  auto changes = overlay_.routes().on_table(from.id, from.cost, entries, now);
  own_.counters.routes_refused += overlay_.routes().take_refused();
  const auto work = entries.size() / entries_per_work + changes.size() * links_.size() / 2;
  rate_.take(work, now);
  own_.work.add(work);
  return changes;
}

void routing_exchange::trigger(instant now) {
  next_trigger_ = earliest(next_trigger_, std::max(now, last_trigger_ + own_.config.trigger_gap));
}

void routing_exchange::trigger_calmly(instant now) {
  const auto hosts = overlay_.routes().routes().size();
  const auto gaps = static_cast<duration::rep>(std::max<std::size_t>(1, hosts / (hosts_many / 2)));
  next_trigger_ =
      earliest(next_trigger_, std::max(now, last_trigger_ + gaps * own_.config.trigger_gap));
}

void routing_exchange::send_due(const occasion& x) {
  if (next_trigger_ && *next_trigger_ <= x.now)
    send(x);
}

void routing_exchange::send(const occasion& x) {
  next_trigger_.reset();
  if (own_.left)
    return;
  last_trigger_ = x.now;
  overlay_.routes().next_seqno();
  for (auto& [link, each] : links_.all()) {
    if (each.open)
      send_to(each, x.origin);
  }
}

void routing_exchange::send_to(connection& to, link_id origin) {
  ++own_.counters.routing_sendings;
  const auto connections = static_cast<std::uint8_t>(std::min(links_.open(), connections_max));
  auto entries = overlay_.routes().table_for(to.id, connections);
  const auto number = entries.front().seqno;
  if (const auto drained = drains_.find(to.id); drained != drains_.end())
    hold_back(entries, drained->second.frozen);
  for (const auto& page : paginate(entries, number))
    sender_.send_to_neighbour(to, port::routing, encode(page), origin);
}

/// Those of links that have ended meanwhile are not needed any more.
void routing_exchange::drain(link_id link, instant until) {
  std::erase_if(drains_, [this](const auto& x) { return !links_.contains(x.first); });
  auto frozen = overlay_.routes().table_for(own_origin, connections_unknown);
  std::ranges::sort(frozen, {}, &routing_entry::id);
  drains_[link] = {until, std::move(frozen)};
  overlay_.routes().next_seqno();
  send_to(links_.at(link), own_origin); // the neighbour sees it by our own number, which stays
}

std::optional<instant> routing_exchange::drained_at(link_id link) const {
  const auto found = drains_.find(link);
  return found == drains_.end() ? std::nullopt : std::optional(found->second.until);
}

void routing_exchange::begin_period(instant now) {
  next_period_ += own_.config.routing_period;
  if (next_period_ <= now)
    restart_period(now); // late: once, without catching up
}

} // namespace rubicon::peis
