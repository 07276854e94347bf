// Another peer uses our id (peis/overlay/id_rivalry.hpp), or two others use one.
#include <algorithm>
#include <utility>

#include "peis/overlay/p2p.hpp"

namespace rubicon::peis {

namespace {

constexpr duration alive_within = 1500ms; // of a marked neighbour's last word: it beats each second

} // namespace

void p2p::note_duplicate(const host_record& other, instant now) {
  ++counters_.duplicate_id;
  settle(rivalry_.note(other, now), now);
}

/// The other end of a link answers with our own id.
void p2p::hear_own_id(link_id from, const package_header& header, byte_view data, instant now) {
  if (header.type != package_type::link || header.port != port::host_record)
    return;
  const auto message = decode_host_record_message(data);
  if (!message || message->record.id != self_.id)
    return;
  connections_.at(from).rivals = true;
  if (message->record.magic != self_.magic)
    return note_duplicate(message->record, now);
  if (const auto& link = connections_.at(from); link.tried_here && link.tried_for) {
    note_elsewhere(*link.tried_for); // we have called ourselves
    close(from, close_cause::own_id, now);
  }
}

void p2p::handle(id_taken& x, instant now) {
  const bool leaves = x.stays_away > duration(0);
  events_.emplace_back(std::move(x));
  if (leaves)
    vacate_id(now);
}

void p2p::handle(const id_regained& /*x*/, instant now) {
  next_period_ = now + config_.routing_period;
}

/// Keeps off the network, without a goodbye: that would be taken for the other's.
void p2p::vacate_id(instant now) {
  ++counters_.ids_yielded;
  std::vector<link_id> links;
  for (const auto& [link, x] : connections_)
    links.push_back(link);
  for (const auto link : links)
    close(link, close_cause::own_id, now);
  attempts_.clear();
  for (auto& x : standing_)
    x.trying = false;
  std::set<peer_id> known;
  for (const auto& [id, x] : hosts_)
    known.insert(id);
  for (const auto& [id, x] : routing_.routes())
    known.insert(id);
  for (const auto id : known)
    delete_host(id, dead_host_message::reason::route, now);
  next_trigger_.reset();
}

/// A link whose other end is a host of our kind, as we know it, that was heard just now; what waits
/// to be handled counts.
std::optional<link_id> p2p::living_link(peer_id id, std::optional<link_id> except,
                                        instant now) const {
  const auto known = hosts_.find(id);
  if (known == hosts_.end() || !known->second.record.marked || !neighbours_.contains(id))
    return std::nullopt;
  const auto at = std::ranges::find_if(connections_, [&](const auto& entry) {
    const auto& x = entry.second;
    return x.id != except && x.open && x.named && x.neighbour == id &&
           x.magic == known->second.record.magic && now - x.last_octets < alive_within;
  });
  return at == connections_.end() ? std::nullopt : std::optional(at->first);
}

/// What a neighbour that is alive says of itself comes over its own link.
bool p2p::is_impersonation(link_id from, const package_header& header, instant now) const {
  if (header.port != port::dead_host && header.port != port::host_record)
    return false;
  const auto known = hosts_.find(header.source);
  if (known == hosts_.end() || !neighbours_.contains(header.source))
    return false;
  const auto& x = connections_.at(from);
  const bool introduces_itself = !x.named && header.port == port::host_record;
  const bool is_its_own =
      x.named && x.neighbour == header.source && x.magic == known->second.record.magic;
  const bool believed = header.hops <= 1 && (introduces_itself || is_its_own);
  return !believed && living_link(header.source, from, now);
}

/// A newcomer with the id of a neighbour that was heard just now is sent away; after a restart the
/// earlier incarnation has been silent when its successor tries again.
bool p2p::refuse_rival(connection& from, const host_record& record, instant now) {
  const auto known = hosts_.find(record.id);
  if (known == hosts_.end() || !known->second.record.marked ||
      known->second.record.magic == record.magic)
    return false;
  const auto& owner = known->second.record;
  const auto alive = living_link(record.id, from.id, now);
  if (!alive)
    return false;
  ++counters_.rivals_refused;
  ++counters_.links_refused;
  auto& x = known->second;
  if (std::exchange(x.rival, record.magic) != record.magic)
    x.rival_first = now;
  if (x.rival_first + alive_within <= now) { // a successor would be in by now
    tell_taken(connections_.at(*alive), record);
    tell_taken(from, owner);
  }
  static_cast<void>(write(from, now)); // who hears who we are takes this for no refusal of links
  close(from.id, close_cause::own_id, now);
  return true;
}

/// One that was followed by another describes itself again: both are there.
void p2p::tell_rivals(link_id from, const host_record& record) {
  const auto known = hosts_.find(record.id);
  if (known == hosts_.end() || known->second.before != record.magic ||
      known->second.record.magic == record.magic)
    return;
  const auto& other = known->second.record;
  tell_host(record.id, from, lane::high, port::host_record,
            encode(host_record_message{other, true}));
  for (auto& [link, x] : connections_) {
    if (link != from && x.open && x.neighbour == record.id && x.magic == other.magic)
      tell_taken(x, record);
  }
}

void p2p::tell_taken(connection& to, const host_record& by) {
  tell_neighbour(to, port::host_record, encode(host_record_message{by, true}));
}

/// Who asks for a link in our own name learns whose it is.
void p2p::refuse_own_id(connection& to) {
  tell_neighbour(to, port::host_record, encode(host_record_message{self_, false}));
  to.open = true;
  static_cast<void>(write(to, to.last_heard));
}

} // namespace rubicon::peis
