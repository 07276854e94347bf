// Routing and hosts (peis-wire.md 9 to 11).
#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include "peis/overlay/p2p.hpp"

namespace rubicon::peis {

namespace {

constexpr std::size_t entries_per_work = 8;
constexpr int burial_periods = 3; ///< how long stale news of a host that left are ignored
/// A real kernel that has had no route to us for 30 s has forgotten our subscriptions (peis-wire.md
/// 9.5); what we miss of the time and it does not is less than half of it.
constexpr duration given_up_after = 15s;

} // namespace

void p2p::on_routing(link_id from, byte_view data, instant now) {
  auto page = decode_routing_page(data);
  if (!page) {
    ++counters_.malformed;
    return;
  }
  auto& x = connections_.at(from);
  auto& collection = x.pages;
  if (collection.seqno != page->seqno || collection.pages.size() != page->pages) {
    collection.seqno = page->seqno;
    collection.pages.assign(page->pages, std::nullopt);
  }
  collection.pages[page->page] = std::move(*page);
  std::vector<routing_entry> entries;
  for (const auto& part : collection.pages) {
    if (!part)
      return;
    entries.insert(entries.end(), part->entries.begin(), part->entries.end());
  }
  collection.pages.clear();
  const bool in_time = x.table_rate.free_at() <= now && routing_rate_.free_at() <= now;
  counters_.tables_put_off += in_time ? 0 : 1;
  x.table = std::move(entries);
  if (in_time)
    apply_table(x, now);
  else
    next_tables_ =
        earliest(next_tables_, std::max(x.table_rate.free_at(), routing_rate_.free_at()));
}

/// What a table costs is not for its neighbour alone to pay: it may send the same, in which all
/// changes, again and again. The newest is applied when its time has come.
void p2p::apply_table(connection& from, instant now) {
  const auto entries = std::move(*std::exchange(from.table, std::nullopt));
  from.table_rate.take(1, now);
  const auto outer = std::exchange(serving_, from.id);
  const auto changes = routing_.on_table(from.id, from.cost, entries, now);
  counters_.routes_refused += routing_.take_refused();
  const auto work = entries.size() / entries_per_work + changes.size() * connections_.size() / 2;
  routing_rate_.take(work, now);
  work_.add(work);
  apply(changes, now);
  end_doubtful_beside(from.id, now);
  for (const auto host : routing_.take_evicted()) {
    if (!reachable(host))
      delete_host(host, dead_host_message::reason::route, now);
  }
  if (routing_.take_overtaken())
    trigger_routing(now);
  serving_ = outer;
}

/// Those that came too soon, one link after the other.
void p2p::apply_tables(instant now) {
  if (!next_tables_ || now < *next_tables_)
    return;
  next_tables_.reset();
  std::vector<link_id> waiting;
  for (const auto& [link, x] : connections_) {
    if (x.table)
      waiting.push_back(link);
  }
  const auto first = std::ranges::upper_bound(waiting, last_table_);
  std::rotate(waiting.begin(), first, waiting.end());
  for (const auto link : waiting) {
    const auto at = connections_.find(link);
    if (at == connections_.end() || !at->second.table)
      continue;
    const auto due = std::max(at->second.table_rate.free_at(), routing_rate_.free_at());
    if (due > now) {
      next_tables_ = earliest(next_tables_, due);
      continue;
    }
    last_table_ = link;
    apply_table(at->second, now);
    static_cast<void>(work_.take()); // nobody is being served
  }
}

/// Only reachability spreads at once: a mere change of preference would echo round every cycle.
void p2p::apply(const routing_changes& changes, instant now) {
  for (const auto& [host, what] : changes) {
    if (what == routing_change::kind::lost) {
      strangers_.forget(host);
      heard_over_.erase(host);
      note_loss(host, now);
    } else if (knows_present(host)) {
      strangers_.forget(host);
      welcome(host, now);
    } else {
      note_stranger(host, now);
    }
  }
  if (!changes.empty())
    trigger_routing(now);
  probe_unsound(now);
  update_cluster(now);
}

void p2p::trigger_routing(instant now) {
  if (!next_trigger_)
    next_trigger_ = std::max(now, last_trigger_ + config_.trigger_gap);
}

void p2p::send_routing(instant now) {
  next_trigger_.reset();
  if (left_)
    return;
  last_trigger_ = now;
  routing_.next_seqno();
  for (auto& [link, x] : connections_) {
    if (x.open)
      send_routing_to(x);
  }
}

void p2p::send_routing_to(connection& to) {
  ++counters_.routing_sendings;
  const auto entries = routing_.table_for(to.id, own_connections());
  for (const auto& page : paginate(entries, entries.front().seqno))
    tell_neighbour(to, port::routing, encode(page));
}

void p2p::on_period(instant now) {
  next_period_ += config_.routing_period;
  if (next_period_ <= now)
    next_period_ = now + config_.routing_period; // late: once, without catching up
  for (const auto id : routing_.age(now))
    delete_host(id, dead_host_message::reason::route, now);
  send_routing(now);
  expire_hosts(now);
  review_hosts(now);
}

void p2p::on_host_record(link_id from, const package_header& header, byte_view data, instant now) {
  const auto message = decode_host_record_message(data);
  if (!message || (!message->cached && message->record.id != header.source)) {
    ++counters_.malformed;
    return;
  }
  const auto& record = message->record;
  const bool is_own_word = header.hops == 1 && !message->cached;
  if (const auto& link = connections_.at(from);
      link.tried_here && link.tried_for && is_own_word && record.id != *link.tried_for)
    note_elsewhere(*link.tried_for);
  if (record.id == self_.id) {
    if (record.magic != self_.magic) {
      connections_.at(from).rivals = true;
      note_duplicate(record, now);
    }
    return;
  }
  // What a record leads to may close the link that it came over.
  const auto is_gone = [this, from] { return !connections_.contains(from); };
  if (is_gone())
    return;
  // The first to describe itself over a link is the neighbour there, for good.
  auto& x = connections_.at(from);
  if (!message->cached && header.type != package_type::broadcast)
    tell_rivals(from, record);
  if (is_gone())
    return;
  if (is_own_word && refuse_rival(x, record, now))
    return;
  for (auto& address : standing_) {
    if (address.link == from && is_own_word && x.tried_for && record.id != *x.tried_for) {
      address.link.reset(); // somebody else lives where its host was
      address.next = now + config_.connections.always_retry_max;
    } else if (address.link == from && (!message->cached || !x.neighbour)) {
      address.host = x.neighbour.value_or(record.id); // a referral begins with who refers
      address.wait = message->cached ? address.wait : config_.connections.always_retry;
    }
  }
  const bool is_neighbour = is_own_word && x.neighbour.value_or(record.id) == record.id;
  const bool same_host = is_here(record);
  const bool asked_for =
      std::ranges::any_of(standing_, [from](const auto& address) { return address.link == from; });
  if (config_.connections.leaf && is_neighbour && !same_host && !asked_for) {
    store_record(*message, now);
    ++counters_.links_refused;
    close(from, close_cause::leaf, now);
    return;
  }
  const bool meets_original = is_neighbour && !record.marked && !has_named_link(record.id);
  if (is_neighbour) {
    x.cost = same_host ? config_.cost_same_host : config_.cost_other_host;
    x.magic = record.magic;
    x.named = true;
    if (!record.marked)
      pace(x);
    bind_neighbour(x, record.id, now);
  }
  store_record(*message, now);
  if (is_gone())
    return;
  if (meets_original)
    show_ourselves(x);
  else if (!message->cached)
    hear_beyond(from, header, record, now);
}

bool p2p::is_here(const host_record& x) const {
  const auto known = elsewhere_.find(x.id);
  return x.host_name == self_.host_name && (known == elsewhere_.end() || known->second != x.magic);
}

bool p2p::shares_host(peer_id host) const {
  const auto* record = find_host(host);
  return record != nullptr && is_here(*record);
}

/// A loopback address that it has told leads to somebody else: either that one has taken its place,
/// or it is on another computer. That has network addresses, and none of ours.
void p2p::note_elsewhere(peer_id host) {
  const auto known = hosts_.find(host);
  if (known == hosts_.end() || !is_here(known->second.record))
    return;
  const auto remote = [](const host_record& x) {
    std::set<std::array<std::uint8_t, 4>> all;
    for (const auto& each : x.addresses)
      if (each.type == low_level_address::kind::tcp_ipv4 && !each.loopback)
        all.insert({each.address[0], each.address[1], each.address[2], each.address[3]});
    return all;
  };
  const auto ours = remote(self_);
  const auto its = remote(known->second.record);
  if (its.empty() || std::ranges::any_of(its, [&](const auto& x) { return ours.contains(x); }))
    return;
  constexpr std::size_t elsewhere_max = 256;
  if (elsewhere_.size() >= elsewhere_max)
    elsewhere_.clear(); // they are found again
  elsewhere_[host] = known->second.record.magic;
  contacts_.erase(host); // it is tried there at once
  events_.push_back(namesake_found{host, known->second.record.full_name});
}

/// Tells the kernel above once both a way to a host and its record are there.
void p2p::welcome(peer_id id, instant now) {
  const auto known = hosts_.find(id);
  if (known == hosts_.end() || !reachable(id))
    return;
  auto& x = known->second;
  if (x.record.marked)
    routing_.mark(id);
  const auto lost = std::exchange(x.lost, std::nullopt);
  missing_.erase(id);
  if (std::exchange(x.forgotten, false))
    tell_forgotten(id);
  if (x.announced) {
    if (lost && *lost + given_up_after <= now)
      events_.push_back(forgotten_by{id});
    return;
  }
  x.announced = true;
  ++welcomed_;
  events_.push_back(host_appeared{id, x.record.magic});
}

void p2p::note_loss(peer_id id, instant now) {
  const auto known = hosts_.find(id);
  if (known == hosts_.end() || known->second.lost || reachable(id))
    return;
  known->second.lost = now;
  if (known->second.announced)
    missing_.insert(id);
}

/// What it has subscribed to here is gone, and what it had told us.
void p2p::tell_forgotten(peer_id id) {
  send({id,
        port::dead_host,
        {encode(dead_host_message{self_.id, dead_host_message::reason::reborn}), {}},
        true,
        priority::high,
        no_request});
}

void p2p::on_dead_host(const package_header& header, byte_view data, instant now) {
  const auto message = decode_dead_host(data);
  if (!message || message->host != header.source) {
    ++counters_.malformed;
    return;
  }
  switch (message->why) {
  case dead_host_message::reason::message:
    break;
  case dead_host_message::reason::route:
    if (header.type == package_type::broadcast) {
      delete_host(message->host, dead_host_message::reason::message, now);
    } else { // it has given us up, but it is there: both begin anew (peis-wire.md 11)
      forget_host(message->host);
      if (reachable(message->host))
        note_stranger(message->host, now);
    }
    break;
  case dead_host_message::reason::reborn:
    events_.push_back(forgotten_by{message->host});
    trigger_routing(now); // if it took another one for us, this shows who lives
    break;
  }
}

/// Gives a host up: it has told that it exits (message), or it was lost for too long (route).
void p2p::delete_host(peer_id id, dead_host_message::reason why, instant now) {
  const auto known = hosts_.find(id);
  const auto* way = routing_.find(id);
  if (known == hosts_.end() && way == nullptr && !neighbours_.contains(id))
    return;
  const auto magic = known != hosts_.end() ? known->second.record.magic
                     : way != nullptr      ? way->magic
                                           : any_magic;
  const bool exits = why == dead_host_message::reason::message;
  if (known != hosts_.end() && !exits)
    remember(known->second.record, now);
  forget_host(id);
  contacts_.erase(id);
  if (exits)
    routing_.bury(id, magic, now + burial_periods * config_.routing_period);
  routing_.erase(id);
  close_links_to(id, close_cause::host_left, now);
  trigger_routing(now);
}

void p2p::close_links_to(peer_id id, close_cause why, instant now) {
  std::vector<link_id> links;
  for (const auto& [link, x] : connections_) {
    if (x.neighbour == id)
      links.push_back(link);
  }
  counters_.links_broken += links.size();
  for (const auto link : links)
    close(link, why, now);
}

void p2p::leave() {
  if (left_)
    return;
  static_cast<void>(broadcast(
      port::dead_host, encode(dead_host_message{self_.id, dead_host_message::reason::route})));
  left_ = true;
  rivalry_.end();
  next_trigger_.reset();
}

const host_record* p2p::find_host(peer_id host) const {
  if (host == self_.id)
    return &self_;
  const auto at = hosts_.find(host);
  return at == hosts_.end() ? nullptr : &at->second.record;
}

std::vector<const host_record*> p2p::hosts() const {
  std::vector<const host_record*> all{&self_};
  for (const auto& [id, x] : hosts_)
    all.push_back(&x.record);
  std::sort(all.begin(), all.end(), [](const auto* a, const auto* b) { return a->id < b->id; });
  return all;
}

} // namespace rubicon::peis
