// Two peers with one id (RTE-08, IF-12, ADR-02).
//
// A magic number that has been followed by another one never returns unless two live peers share an
// id. Who notices tells both, with the record of the other; they settle it between them by a rule
// that both can follow: who has come to the network lately leaves, of two alike the one with the
// higher magic number. A peer that cannot leave, being no Rubicon peer, is left the id. Who has
// left tries again after a while, as a newcomer, and so takes over when the other is gone.
#include <algorithm>
#include <utility>

#include "peis/p2p.hpp"

namespace rubicon::peis {

namespace {

constexpr duration newcomer_for = 30s;
// From the first sign of the other to our leaving: each leaves the one before the time to be gone.
constexpr duration newcomer_leaves = 2s;
constexpr duration lower_newcomer_leaves = 8s;
constexpr duration settled_leaves = 15s;
constexpr duration sign_is_fresh = 3s;
constexpr duration rivalry_ends = 10s; // after the last sign
constexpr duration away_first = 15s;   // doubles each time
constexpr duration away_max = 2min;
constexpr duration alive_within = 1500ms; // of a marked neighbour's last word: it beats each second

} // namespace

void p2p::note_duplicate(const host_record& other, instant now) {
  ++counters_.duplicate_id;
  if (std::exchange(duplicate_, other.magic) != other.magic)
    events_.push_back(id_taken{other.full_name, {}});
  if (yielded_until_)
    yielded_until_ = std::max(*yielded_until_, now + away_first);
  else if (rivalry_ && rivalry_->other.magic == other.magic)
    rivalry_->last = now;
  else
    rivalry_ = rivalry{other, now, now, now};
}

/// The other end of a link answers with our own id.
void p2p::hear_own_id(const package_header& header, byte_view data, instant now) {
  if (header.type != package_type::link || header.port != port::host_record)
    return;
  const auto message = decode_host_record_message(data);
  if (message && message->record.id == self_.id && message->record.magic != self_.magic)
    note_duplicate(message->record, now);
}

/// When we leave the id to the other if it goes on showing that it is there.
std::optional<instant> p2p::yields_at() const {
  const auto& [other, first, last, checked] = *rivalry_;
  const bool first_to_leave = self_.magic > other.magic || !other.marked;
  if (first < joined_ + newcomer_for)
    return first + (first_to_leave ? newcomer_leaves : lower_newcomer_leaves);
  return first_to_leave ? std::optional(first + settled_leaves) : std::nullopt;
}

std::optional<instant> p2p::identity_deadline() const {
  if (!rivalry_ || left_) // who has left minds it no more
    return std::nullopt;
  const auto at = yields_at();
  if (at && *at > rivalry_->checked)
    return at;
  if (at && rivalry_->last > rivalry_->checked)
    return rivalry_->last; // another sign when it was due
  return rivalry_->last + rivalry_ends;
}

void p2p::mind_identity(instant now) {
  if (yielded_until_ && *yielded_until_ <= now) {
    yielded_until_.reset();
    joined_ = now;
    duplicate_.reset(); // told again if it is still there
    next_period_ = now + config_.routing_period;
  }
  if (!rivalry_ || left_)
    return;
  rivalry_->checked = now;
  const auto at = yields_at();
  const bool goes_on = rivalry_->last > rivalry_->first && rivalry_->last + sign_is_fresh >= now;
  if (at && *at <= now && goes_on)
    yield_id(now);
  else if (rivalry_->last + rivalry_ends <= now)
    rivalry_.reset();
}

/// Keeps off the network, without a goodbye: that would be taken for the other's.
void p2p::yield_id(instant now) {
  const bool again = joined_ + newcomer_for > now;
  yielded_for_ = again ? std::clamp(2 * yielded_for_, away_first, away_max) : away_first;
  yielded_until_ = now + yielded_for_;
  ++counters_.ids_yielded;
  events_.push_back(id_taken{rivalry_->other.full_name, yielded_for_});
  rivalry_.reset();
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
    static_cast<void>(write(from, now));
  }
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
