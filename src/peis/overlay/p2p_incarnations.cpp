// Which incarnation of a host is there now (peis-wire.md 10, RTE-08, KH-01, KH-02).
//
// Magic numbers are random: two of them do not tell which is the later one. What tells it are the
// routes, because only who lives raises its sequence number, and overtakes an earlier incarnation
// as soon as it hears of it; and the word of a host about itself, unless a route that has been
// renewed since contradicts it. A record that somebody remembers counts only if it fits the route.
// Every host whose record does not fit its route is a stranger, and asked about until one does.
#include <algorithm>
#include <utility>

#include "peis/overlay/p2p.hpp"

namespace rubicon::peis {

namespace {

constexpr std::size_t questions_at_once = 64; ///< of one occasion
constexpr work_units rebirth_work = 500;
constexpr int doubted_periods = 3; ///< what is no news of an earlier incarnation is ignored so long

} // namespace

void p2p::note_stranger(peer_id id, instant now) {
  strangers_.note(id, hosts_.contains(id), now);
}

/// What was missed at a change is found here, once a period.
void p2p::review_hosts(instant now) {
  for (const auto& [id, way] : routing_.routes()) {
    if (way.lost())
      continue;
    if (!knows_present(id))
      note_stranger(id, now);
    else
      strangers_.forget(id);
  }
}

/// Is there a record of the incarnation that the route leads to?
bool p2p::knows_present(peer_id id) const {
  const auto known = hosts_.find(id);
  if (known == hosts_.end())
    return false;
  const auto* way = routing_.find(id);
  if (way != nullptr && !way->lost())
    return way->magic == known->second.record.magic;
  return neighbours_.contains(id);
}

void p2p::ask_strangers(instant now) {
  for (std::size_t i = 0; i < questions_at_once; ++i) {
    const auto next = strangers_.next();
    if (!next || next->first > now || asking_rate_.free_at() > now || left_)
      return;
    const auto id = next->second;
    if (knows_present(id) || !reachable(id)) {
      strangers_.forget(id);
      continue;
    }
    ask_about(strangers_.ask(id, now));
    asking_rate_.take(1, now);
  }
}

/// The first question is for everybody on the way. Where caches mislead, the incarnation itself is
/// asked for: by its magic number, which a real kernel on the way passes on (but does not answer
/// either), and in a message of one fragment, which nobody on the way looks into.
void p2p::ask_about(const stranger_table::question& x) {
  if (!x.misled || x.before % 2 == 1)
    ask(x.host, any_magic, false);
  if (!x.misled && x.before == 0)
    return;
  if (const auto* way = routing_.find(x.host))
    ask(x.host, way->magic, false);
  ask(x.host, any_magic, true);
}

/// A link to an earlier incarnation may still seem to be there: the route is tried beside it.
void p2p::ask(peer_id id, std::int32_t magic, bool sealed) {
  const auto content = std::make_shared<const message_octets>(
      message_octets{encode(host_query{self_.id, magic}), {}});
  const auto direct = way_to(id);
  const auto routed = routing_.way_to(id);
  for (const auto& way : {direct, routed == direct ? std::nullopt : routed}) {
    if (!way)
      continue;
    auto header = fresh_header(package_type::direct, port::host_query);
    header.destination = id;
    if (sealed) {
      header.flags = package_flag::bulk;
      header.seqlen = 1;
      header.seqid = ids_.next_group();
    }
    count_drop(enqueue(connections_.at(*way), lane::high, {header, content, 0}));
  }
}

/// Answers for ourselves or, if we know who is there now, for the destination of a passing
/// question. @returns false if we have no answer
bool p2p::answer_query(link_id from, const package_header& header, byte_view data) {
  const auto query = decode_host_query(data);
  if (!query) {
    ++counters_.malformed;
    return false;
  }
  const bool about_me = header.destination == self_.id;
  if (!about_me && !knows_present(header.destination))
    return false;
  const auto& record = *find_host(header.destination);
  if (!about_me && query->magic != any_magic && query->magic != record.magic)
    return false;
  if (!may_answer(from)) {
    ++counters_.questions_refused;
    return about_me;
  }
  send({header.source,
        port::host_record,
        {encode(host_record_message{record, !about_me}), {}},
        true,
        priority::high,
        no_request,
        from});
  return true;
}

/// Does this tell who is there now?
bool p2p::believes(const host_record_message& message, instant now) const {
  const auto& record = message.record;
  const auto* way = routing_.find(record.id);
  const bool routed = way != nullptr && !way->lost();
  const bool fits = routed && way->magic == record.magic;
  const auto at = hosts_.find(record.id);
  if (at == hosts_.end())
    return !message.cached || fits || !routed;
  const auto& known = at->second;
  if (known.record.magic == record.magic)
    return true;
  if (living_link(record.id, std::nullopt, now))
    return false; // hearsay; who comes over a link of its own has been judged by refuse_rival()
  if (message.cached)
    return fits && way->news > known.own_word;
  // Its own word, but perhaps one that was long in flight.
  return record.magic != known.before || !routed || way->magic != known.record.magic;
}

void p2p::store_record(const host_record_message& message, instant now) {
  const auto& record = message.record;
  if (!believes(message, now)) {
    strangers_.mislead(record.id, now);
    return;
  }
  const auto known = hosts_.find(record.id);
  std::int32_t before = 0;
  std::optional<link_id> from;
  if (known != hosts_.end() && known->second.record.magic != record.magic) {
    before = known->second.record.magic;
    from = known->second.from; // the place in the table stays its own
    work_.add(rebirth_work);
    supersede(record.id, before, now);
    hosts_[record.id].from = *from;
  }
  auto* place = acquaint(record.id);
  if (place == nullptr)
    return;
  auto& stored = *place;
  stored.record = record;
  stored.heard = now;
  if (!message.cached) {
    stored.own_word = now;
    stored.announcer.reset(); // it was met
  }
  if (before != 0)
    stored.before = before;
  recall(stored);
  if (knows_present(record.id))
    strangers_.forget(record.id);
  else if (reachable(record.id))
    note_stranger(record.id, now);
  if (const auto direct = neighbours_.find(record.id); direct != neighbours_.end())
    expect_beat(connections_.at(direct->second));
  welcome(record.id, now);
  if (!reachable(record.id))
    hasten_merge(now);
}

/// A host that was given up is heard of again.
void p2p::recall(acquaintance& x) {
  const auto former = former_.find(x.record.id);
  if (former == former_.end())
    return;
  x.forgotten = x.forgotten || former->second.record.magic == x.record.magic;
  former_.erase(former);
}

/// Another incarnation has taken the place of this one, whose links lead nowhere.
void p2p::supersede(peer_id id, std::int32_t magic, instant now) {
  std::vector<link_id> links;
  for (const auto& [link, x] : connections_) {
    if (x.neighbour == id && x.magic == magic)
      links.push_back(link);
  }
  counters_.links_broken += links.size();
  for (const auto link : links)
    close(link, close_cause::reborn, now);
  forget_host(id);
  contacts_.erase(id);
  routing_.doubt(id, magic, now + doubted_periods * config_.routing_period);
  if (const auto* way = routing_.find(id); way != nullptr && way->magic == magic)
    routing_.erase(id);
  if (reachable(id))
    tell_forgotten(id);
  trigger_routing(now);
}

/// Ends everything that concerns a host but the ways to it.
void p2p::forget_host(peer_id id) {
  const auto known = hosts_.find(id);
  if (known != hosts_.end() && known->second.announced)
    events_.push_back(host_vanished{id});
  for (const auto& x : delivery_.fail_all(id))
    fail(x, cause::host_gone);
  acknowledger_.drop(id);
  assembly_.drop(id);
  strangers_.forget(id);
  stalled_.erase(id);
  missing_.erase(id);
  if (known != hosts_.end()) {
    welcomed_ -= known->second.announced ? 1 : 0;
    hosts_.erase(known);
  }
  heard_over_.erase(id);
  traffic_.forget(id);
  probes_.end(id);
}

} // namespace rubicon::peis
