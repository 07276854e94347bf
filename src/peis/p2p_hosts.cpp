// Routing and hosts (peis-wire.md 9 to 11).
#include <algorithm>
#include <utility>

#include "peis/p2p.hpp"

namespace rubicon::peis {

namespace {

constexpr std::size_t entries_per_work = 8;
constexpr std::size_t asked_each_period = 512;
constexpr work_units rebirth_work = 500;
constexpr int burial_periods = 3; ///< how long stale news of a host that left are ignored

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
      strangers_.erase(host);
      heard_over_.erase(host);
      continue;
    }
    const auto known = hosts_.find(host);
    if (known != hosts_.end() && known->second.record.magic == routing_.find(host)->magic)
      welcome(host);
    else
      note_stranger(host);
  }
  if (!changes.empty())
    trigger_routing(now);
  probe_unsound(now);
  update_cluster(now);
}

void p2p::note_duplicate(const host_record& other) {
  ++counters_.duplicate_id;
  if (std::exchange(duplicate_, other.magic) != other.magic)
    events_.push_back(id_taken{other.full_name});
}

void p2p::note_stranger(peer_id id) {
  if (strangers_.insert(id).second)
    newcomers_.push_back(id);
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
  auto next = strangers_.upper_bound(last_asked_);
  for (auto i = std::min(strangers_.size(), asked_each_period); i > 0; --i) {
    next = next == strangers_.end() ? strangers_.begin() : next;
    last_asked_ = *next++;
    ask_about(last_asked_);
  }
}

/// Real kernels answer only questions that name no magic number, caches among them; where a cached
/// record is the wrong one, every other question is for the incarnation itself (KH-02).
void p2p::ask_about(peer_id stranger) {
  const auto way = way_to(stranger);
  if (!strangers_.contains(stranger) || !way)
    return;
  const auto* known = routing_.find(stranger);
  const bool by_magic = known != nullptr && hosts_.contains(stranger) && questions_++ % 2 == 0;
  tell_host(stranger, *way, lane::high, port::host_query,
            encode(host_query{self_.id, by_magic ? known->magic : any_magic}));
}

/// Answers for ourselves or, from what we know, for the destination of a passing question.
/// @returns false if we have no answer
bool p2p::answer_query(link_id from, const package_header& header, byte_view data) {
  const auto query = decode_host_query(data);
  if (!query) {
    ++counters_.malformed;
    return false;
  }
  const bool about_me = header.destination == self_.id;
  const auto* record = find_host(header.destination);
  if (record == nullptr ||
      (!about_me && query->magic != any_magic && query->magic != record->magic))
    return false;
  if (!may_answer(from)) {
    ++counters_.questions_refused;
    return about_me;
  }
  send({header.source,
        port::host_record,
        {encode(host_record_message{*record, !about_me}), {}},
        true,
        priority::high,
        no_request,
        from});
  return true;
}

void p2p::on_host_record(link_id from, const package_header& header, byte_view data, instant now) {
  const auto message = decode_host_record_message(data);
  if (!message || (!message->cached && message->record.id != header.source)) {
    ++counters_.malformed;
    return;
  }
  const auto& record = message->record;
  if (record.id == self_.id) {
    if (record.magic != self_.magic)
      note_duplicate(record);
    return;
  }
  // The first to describe itself over a link is the neighbour there, for good.
  auto& x = connections_.at(from);
  for (auto& address : standing_) {
    if (address.link == from && (!message->cached || !x.neighbour)) {
      address.host = x.neighbour.value_or(record.id); // a referral begins with who refers
      address.wait = message->cached ? address.wait : config_.connections.always_retry;
    }
  }
  const bool is_neighbour =
      header.hops == 1 && !message->cached && x.neighbour.value_or(record.id) == record.id;
  const bool same_host = record.host_name == self_.host_name;
  const bool asked_for =
      std::ranges::any_of(standing_, [from](const auto& address) { return address.link == from; });
  if (config_.connections.leaf && is_neighbour && !same_host && !asked_for) {
    store_record(from, *message, now);
    ++counters_.links_refused;
    close(from, close_cause::leaf, now);
    return;
  }
  if (is_neighbour) {
    x.cost = same_host ? config_.cost_same_host : config_.cost_other_host;
    x.named = true;
    bind_neighbour(x, record.id);
  }
  store_record(from, *message, now);
}

void p2p::store_record(link_id from, const host_record_message& message, instant now) {
  const auto& record = message.record;
  const auto* way = routing_.find(record.id);
  const bool fits_route = way == nullptr || way->lost() || way->magic == record.magic;
  const auto known = hosts_.find(record.id);
  if (known != hosts_.end() && known->second.record.magic != record.magic) {
    if (message.cached)
      return; // somebody's memory of the incarnation we know to be gone, or not yet (KH-02)
    work_.add(rebirth_work);
    close_links_to(record.id, close_cause::reborn, from, now);
    delete_host(record.id, dead_host_message::reason::reborn, now);
  } else if (message.cached && !fits_route) {
    return;
  }
  auto* stored = acquaint(record.id);
  if (stored == nullptr)
    return;
  stored->record = record;
  stored->heard = now;
  former_.erase(record.id);
  strangers_.erase(record.id);
  if (const auto direct = neighbours_.find(record.id); direct != neighbours_.end())
    expect_beat(connections_.at(direct->second));
  welcome(record.id);
  if (!reachable(record.id))
    hasten_merge(now);
}

/// Tells the kernel above once both a way to a host and its record are there.
void p2p::welcome(peer_id id) {
  const auto known = hosts_.find(id);
  if (known == hosts_.end() || !reachable(id))
    return;
  if (known->second.record.marked)
    routing_.mark(id);
  if (known->second.announced)
    return;
  known->second.announced = true;
  ++welcomed_;
  events_.push_back(host_appeared{id});
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
    delete_host(message->host, dead_host_message::reason::message, now);
    break;
  case dead_host_message::reason::reborn:
    events_.push_back(forgotten_by{message->host});
    break;
  }
}

/// Forgets a host: it has told that it exits (message), it was lost for too long (route), or it has
/// restarted (reborn).
void p2p::delete_host(peer_id id, dead_host_message::reason why, instant now) {
  using reason = dead_host_message::reason;
  const auto known = hosts_.find(id);
  const auto* way = routing_.find(id);
  if (known == hosts_.end() && way == nullptr && !neighbours_.contains(id))
    return;
  const auto magic = known != hosts_.end() ? known->second.record.magic
                     : way != nullptr      ? way->magic
                                           : any_magic;
  if (known != hosts_.end() && known->second.announced)
    events_.push_back(host_vanished{id});
  for (const auto& x : delivery_.fail_all(id))
    fail(x, cause::host_gone);
  acknowledger_.drop(id);
  assembly_.drop(id);
  strangers_.erase(id);
  stalled_.erase(id);
  if (known != hosts_.end()) {
    welcomed_ -= known->second.announced ? 1 : 0;
    if (why == reason::route)
      remember(known->second.record, now);
    hosts_.erase(known);
  }
  heard_over_.erase(id);
  contacts_.erase(id);
  traffic_.erase(id);
  probes_.erase(id);
  if (why != reason::route)
    routing_.bury(id, magic, now + burial_periods * config_.routing_period);
  if (why != reason::reborn || way == nullptr || way->magic == magic)
    routing_.erase(id);
  if (why != reason::reborn) {
    close_links_to(id, close_cause::host_left, std::nullopt, now);
  } else if (reachable(id)) {
    send({id,
          port::dead_host,
          {encode(dead_host_message{self_.id, reason::reborn}), {}},
          true,
          priority::high,
          no_request});
  }
  trigger_routing(now);
}

void p2p::close_links_to(peer_id id, close_cause why, std::optional<link_id> except, instant now) {
  std::vector<link_id> links;
  for (const auto& [link, x] : connections_) {
    if (x.neighbour == id && link != except)
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
