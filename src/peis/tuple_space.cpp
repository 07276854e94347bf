// Own tuples, held tuples, and telling the local subscribers (peis-wire.md 15.3, 15.4).
#include "peis/tuple_space.hpp"

#include <algorithm>
#include <limits>

#include "peis/package.hpp"

namespace rubicon::peis {

namespace {

/// Network time of an ecology time; nothing if the wire's 32 bits cannot hold it.
std::optional<timestamp> to_timestamp(instant x, duration offset) {
  const auto since = x.time_since_epoch() + offset;
  const auto whole = std::chrono::floor<std::chrono::seconds>(since);
  if (whole.count() < 2 || whole.count() > std::numeric_limits<std::int32_t>::max())
    return std::nullopt; // 0 and 1 have meanings of their own (peis-wire.md 15.1, 15.4)
  const auto rest = std::chrono::duration_cast<std::chrono::microseconds>(since - whole);
  return timestamp{static_cast<std::int32_t>(whole.count()),
                   static_cast<std::int32_t>(rest.count())};
}

/// Does a pushed tuple replace the one held? A number restarts at zero when a real owner restarts
/// or creates the tuple anew, hence the time (peis-wire.md 15.3); a deletion that was overtaken by
/// a newer value must not remove it.
bool supersedes(const tuple& x, const tuple& held, bool deletion) {
  if (x.written > held.written)
    return true;
  return x.seqno > held.seqno && (!deletion || x.written == held.written);
}

} // namespace

tuple_space::tuple_space(tuple_space_config config, peer_id self, duration clock_offset)
    : config_(config), self_(self), clock_offset_(clock_offset) {}

timestamp tuple_space::network_time(instant now) const {
  return to_timestamp(now, clock_offset_).value_or(never);
}

std::optional<instant> tuple_space::expiry_of(const tuple& x) const {
  if (x.expiry == never)
    return std::nullopt;
  if (x.expiry == deleted)
    return instant::min();
  return instant(std::chrono::seconds(x.expiry.seconds) +
                 std::chrono::microseconds(x.expiry.microseconds) - clock_offset_);
}

bool tuple_space::full(const key& name, peer_id owner) const {
  return store_.size() >= config_.tuples_max && store_.find(name, owner) == nullptr;
}

result<tuple> tuple_space::draft(peer_id owner, const key& name, tuple_content content,
                                 instant now) const {
  tuple x;
  x.owner = owner;
  x.creator = self_;
  x.name = name;
  x.form = content.form;
  x.written = network_time(now);
  x.mimetype = content.value.empty() ? std::string(empty_mimetype) : std::move(content.mimetype);
  x.value = std::move(content.value);
  if (x.mimetype.empty() || x.mimetype.size() > mimetype_length_max || x.form == encoding::any)
    return errc::bad_value;
  if (content.expiry) {
    const auto expiry = to_timestamp(*content.expiry, clock_offset_);
    if (!expiry)
      return errc::bad_value;
    x.expiry = *expiry;
  }
  return x;
}

std::pair<cause, tuple_events> tuple_space::set(const key& name, tuple_content content,
                                                instant now) {
  auto x = draft(self_, name, std::move(content), now);
  cause why = cause::none;
  if (name.is_pattern())
    why = cause::bad_key;
  else if (!x)
    why = cause::bad_value;
  else if (full(name, self_))
    why = cause::refused;
  if (why != cause::none) {
    ++counters_.refused;
    return {why, {}};
  }
  return {cause::none, store_own(std::move(*x))};
}

tuple_events tuple_space::store_own(tuple x) {
  ++counters_.sets;
  const auto* held = store_.find(x.name, self_);
  x.seqno = held != nullptr ? held->seqno + 1 : first_seqno_;
  const auto expiry = expiry_of(x);
  const auto& stored = store_.put(std::move(x), expiry);
  tuple_events out;
  push(stored, out);
  tell_changed(stored, out);
  return out;
}

/// Deleting is setting with an expiry in the past and a value of one octet (peis-wire.md 15.4).
tuple_events tuple_space::remove(const key& name, instant now) {
  tuple_events out;
  auto gone = store_.remove(name, self_);
  if (!gone)
    return out;
  auto last = *gone;
  last.seqno = gone->seqno + 1;
  last.written = network_time(now);
  last.expiry = deleted;
  last.value = payload(bytes{0});
  first_seqno_ = std::max(first_seqno_, last.seqno + 1);
  push(last, out);
  tell_deleted(*gone, out);
  return out;
}

std::pair<cause, transmit> tuple_space::ask_owner(peer_id owner, const key& name,
                                                  std::optional<tuple_content> content,
                                                  request_id request, instant now) const {
  if (name.is_pattern())
    return {cause::bad_key, {}};
  const bool deletion = !content;
  auto x = draft(owner, name, deletion ? text_content("") : std::move(*content), now);
  if (!x)
    return {cause::bad_value, {}};
  if (deletion)
    x->expiry = deleted;
  return {cause::none,
          {owner,
           port::set,
           {encode_tuple_head(*x, tuple_message_kind::set), encode_tuple_value(*x)},
           request}};
}

std::optional<tuple> tuple_space::decode_set(bytes octets) {
  auto x = decode_tuple_message(std::move(octets));
  if (!x || x->owner != self_) {
    ++counters_.malformed;
    return std::nullopt;
  }
  return std::move(*x);
}

tuple_events tuple_space::on_set(const tuple& x, bool may_write, instant now) {
  if (!may_write) {
    ++counters_.refused;
    return {};
  }
  if (full(x.name, self_)) {
    ++counters_.overflow;
    return {};
  }
  ++counters_.remote_sets;
  if (x.expiry == deleted)
    return remove(x.name, now);
  auto own = x;
  own.written = network_time(now);
  return store_own(std::move(own));
}

tuple_events tuple_space::on_push(peer_id source, bytes octets, instant now) {
  ++counters_.pushes_received;
  auto x = decode_tuple_message(std::move(octets));
  if (!x || x->owner != source || source == self_) {
    ++counters_.malformed;
    return {};
  }
  if (!wanted(*x)) {
    ++counters_.unwanted;
    return {};
  }
  const auto expiry = expiry_of(*x);
  const bool deletion = expiry && *expiry <= now;
  const auto* held = store_.find(x->name, source);
  if (held == nullptr ? deletion : !supersedes(*x, *held, deletion)) {
    ++counters_.outdated;
    return {};
  }
  tuple_events out;
  if (deletion) {
    tell_deleted(*store_.remove(x->name, source), out);
  } else if (full(x->name, source)) {
    ++counters_.overflow;
  } else {
    tell_changed(store_.put(std::move(*x), expiry), out);
  }
  return out;
}

/// Local subscriptions that a tuple concerns, in the order of their ids.
std::vector<subscription_id> tuple_space::interested(const tuple& x) const {
  std::vector<subscription_id> ids;
  wanted_.for_matching(x.name, [&](const subscription& wanted) {
    if (wanted.owner == any_peer || wanted.owner == x.owner)
      ids.push_back(wanted.id);
  });
  std::sort(ids.begin(), ids.end());
  return ids;
}

bool tuple_space::wanted(const tuple& x) const {
  return !interested(x).empty();
}

void tuple_space::tell_changed(const tuple& x, tuple_events& out) const {
  for (const auto id : interested(x))
    out.push_back(tuple_changed{id, x});
}

void tuple_space::tell_deleted(const tuple& x, tuple_events& out) const {
  for (const auto id : interested(x))
    out.push_back(tuple_deleted{id, x});
}

tuple_events tuple_space::on_host_vanished(peer_id host) {
  tuple_events out;
  std::vector<key> names;
  for (const auto* x : store_.find_all(host, key()))
    names.push_back(x->name);
  for (const auto& name : names)
    tell_deleted(*store_.remove(name, host), out);
  subscribers_.erase_everywhere([host](const subscriber& x) { return x.host == host; });
  std::erase_if(failed_, [host](const auto& x) { return x.first.first == host; });
  renewals_.erase(host);
  hosts_.erase(host);
  return out;
}

tuple_events tuple_space::on_time(instant now) {
  tuple_events out;
  while (const auto gone = store_.take_expired(now)) {
    ++counters_.expired;
    if (gone->owner == self_)
      first_seqno_ = std::max(first_seqno_, gone->seqno + 1);
    tell_deleted(*gone, out);
  }
  if (next_retry_ && *next_retry_ <= now)
    retry_pushes(now, out);
  if (next_refresh_ && *next_refresh_ <= now)
    refresh(now, out);
  return out;
}

std::optional<instant> tuple_space::deadline() const {
  return earliest(store_.deadline(), earliest(next_retry_, next_refresh_));
}

const tuple* tuple_space::find(peer_id owner, const key& name) const {
  return store_.find(name, owner);
}

std::vector<const tuple*> tuple_space::find_all(peer_id owner, const key& pattern) const {
  return store_.find_all(owner, pattern);
}

tuple_counters tuple_space::counters() const {
  auto all = counters_;
  all.tuples = store_.size();
  all.subscriptions = subscriptions_.size();
  all.subscribers = subscribers_.size();
  return all;
}

} // namespace rubicon::peis
