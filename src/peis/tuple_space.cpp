// Own tuples, held tuples, and telling the local subscribers (peis-wire.md 15.3, 15.4).
#include "peis/tuple_space.hpp"

#include <algorithm>
#include <limits>

#include "peis/package.hpp"

namespace rubicon::peis {

namespace {

/// Network time of an ecology time; nothing where seconds have meanings of their own: `deleted` and
/// all below.
std::optional<timestamp> to_timestamp(instant x, duration offset) {
  const auto since = x.time_since_epoch() + offset;
  const auto whole = std::chrono::floor<std::chrono::seconds>(since);
  if (whole.count() <= deleted.seconds)
    return std::nullopt;
  const auto rest = std::chrono::duration_cast<std::chrono::microseconds>(since - whole);
  return timestamp{whole.count(), static_cast<std::int32_t>(rest.count())};
}

} // namespace

tuple_space::tuple_space(tuple_space_config config, peer_id self, duration clock_offset)
    : config_(config), self_(self), clock_offset_(clock_offset),
      others_(std::make_shared<fair_share>(config.others_octets_max)),
      store_({config.written_octets_max, config.held_octets_max, others_}),
      channels_(config.appends_waiting_max, config.appends_waiting_octets_max),
      subscribers_({config.subscribers_max, config.subscribers_octets_max, others_,
                    config.subscribers_per_key_max}),
      window_(config.pushes) {}

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
  return store_.size() >= config_.tuples_max && store_.find(owner, name) == nullptr;
}

std::optional<tuple> tuple_space::draft(peer_id owner, const key& name,
                                        tuple_content content) const {
  tuple x;
  x.owner = owner;
  x.name = name;
  x.form = content.form;
  x.mimetype = std::move(content.mimetype);
  x.value = std::move(content.value);
  if (content.expiry) {
    const auto expiry = to_timestamp(*content.expiry, clock_offset_);
    if (!expiry)
      return std::nullopt;
    x.expiry = *expiry;
  }
  return x;
}

/// Checks what a user has filled in and fills in the rest.
cause tuple_space::prepare(tuple& x, instant now) const {
  if (x.owner == any_peer || x.name.is_pattern() || is_wildcard(x.user_time) ||
      is_wildcard(x.expiry) || x.form == encoding::any || x.mimetype.empty())
    return cause::abstract;
  if (x.owner.value <= 0 || x.mimetype.size() > mimetype_length_max)
    return cause::bad_value;
  if (x.value.size() > tuple_value_max)
    return cause::too_long;
  const auto written = network_time(now);
  if (x.expiry.seconds > written.seconds + std::numeric_limits<std::int32_t>::max())
    return cause::bad_value; // others would take it for a time in the past
  if (x.value.empty())
    x.mimetype = empty_mimetype;
  x.creator = self_;
  x.written = written;
  x.seqno = x.append_seqno = 0;
  x.stale = false;
  return cause::none;
}

std::pair<cause, tuple_events> tuple_space::set(const key& name, tuple_content content,
                                                instant now) {
  auto x = draft(self_, name, std::move(content));
  if (x && !name.is_pattern())
    return insert(std::move(*x), now);
  ++counters_.refused;
  return {x ? cause::bad_key : cause::bad_value, {}};
}

std::pair<cause, tuple_events> tuple_space::insert(tuple x, instant now) {
  auto why = prepare(x, now);
  if (why == cause::none && full(x.name, self_))
    why = cause::space_full;
  if (why != cause::none) {
    ++counters_.refused;
    return {why, {}};
  }
  if (x.expiry == deleted)
    return {why, remove(x.name, now)};
  return {why, store_own(std::move(x), {}, now)};
}

tuple_pointer tuple_space::put_own(tuple x, tuple_store::source by) {
  const auto held = store_.size();
  const auto expiry = expiry_of(x);
  auto stored = store_.put(std::move(x), expiry, by);
  own_keys_version_ += store_.size() != held ? 1 : 0;
  return stored;
}

tuple_events tuple_space::store_own(tuple x, tuple_store::source by, instant now) {
  ++counters_.sets;
  const auto* held = store_.find(self_, x.name);
  x.seqno = held != nullptr ? held->content->seqno + 1 : first_seqno_;
  x.append_seqno = 0;
  static_cast<void>(channels_.abandon(x.name)); // the whole value goes to everybody
  const auto stored = put_own(std::move(x), by);
  tuple_events out;
  push(*stored, now, out);
  tell_changed(stored, out);
  return out;
}

void tuple_space::forget_own(const tuple& gone) {
  first_seqno_ = std::max(first_seqno_, gone.seqno + 2); // a deletion may have had one of its own
  ++own_keys_version_;
  static_cast<void>(channels_.abandon(gone.name));
}

/// Deleting is setting with an expiry in the past and a value of one octet (peis-wire.md 15.4).
tuple_events tuple_space::remove(const key& name, instant now) {
  tuple_events out;
  const auto gone = store_.remove(self_, name);
  if (!gone)
    return out;
  forget_own(*gone);
  auto last = *gone;
  last.seqno = gone->seqno + 1;
  last.written = network_time(now);
  last.expiry = deleted;
  last.value = payload(bytes{0});
  last.from = {};
  push(last, now, out);
  tell_deleted(gone, out);
  return out;
}

std::pair<cause, transmit> tuple_space::ask_to_set(tuple x, request_id request, instant now) const {
  const auto why = prepare(x, now);
  if (why != cause::none)
    return {why, {}};
  return {cause::none,
          {x.owner,
           port::set,
           {encode_tuple_head(x, tuple_message_kind::set), encode_tuple_value(x)},
           request}};
}

std::pair<cause, transmit> tuple_space::ask_to_delete(peer_id owner, const key& name,
                                                      request_id request, instant now) const {
  if (name.is_pattern())
    return {cause::bad_key, {}};
  tuple x;
  x.owner = owner;
  x.name = name;
  x.expiry = deleted;
  x.value = payload(bytes{0});
  return ask_to_set(std::move(x), request, now);
}

std::optional<tuple> tuple_space::decode_set(const payload& octets, instant now) {
  auto x = decode_tuple_message(octets, network_time(now));
  if (!x || x->owner != self_) {
    ++counters_.malformed;
    return std::nullopt;
  }
  return std::move(*x);
}

tuple_events tuple_space::on_set(peer_id source, const tuple& x, bool may_write, instant now) {
  if (!may_write) {
    ++counters_.refused;
    return {};
  }
  if (x.expiry == deleted) {
    ++counters_.remote_sets;
    return remove(x.name, now);
  }
  const tuple_store::source by{tuple_store::origin::written, source};
  if (full(x.name, self_) || !store_.admits(x, by)) {
    ++counters_.overflow;
    return {};
  }
  if (!acquainted(source, now))
    return {};
  ++counters_.remote_sets;
  auto own = x;
  own.written = network_time(now);
  return store_own(std::move(own), by, now);
}

/// Does a pushed tuple replace the one held? A number restarts at zero when a real owner restarts
/// or creates the tuple anew, hence the time (peis-wire.md 15.3); a deletion that was overtaken by
/// a newer value must not remove it. What was asked for because ours is incomplete or stale has
/// the same number and time.
bool tuple_space::replaces(const tuple& x, const tuple& held, bool deletion) const {
  if (x.written > held.written)
    return true;
  if (x.seqno > held.seqno)
    return !deletion || x.written == held.written;
  const bool asked_for = held.stale || incomplete_.contains({held.owner, held.name.folded()});
  return asked_for && x.seqno == held.seqno && x.written == held.written;
}

tuple_events tuple_space::on_push(peer_id source, const payload& octets, instant now) {
  ++counters_.pushes_received;
  auto x = decode_tuple_message(octets, network_time(now));
  if (!x || x->owner != source || source == self_) {
    ++counters_.malformed;
    return {};
  }
  const auto expiry = expiry_of(*x);
  const bool deletion = expiry && *expiry <= now;
  const auto* held = store_.find(source, x->name);
  if (!wanted(deletion && held != nullptr ? *held->content : *x)) {
    ++counters_.unwanted;
    return {};
  }
  if (held == nullptr ? deletion : !replaces(*x, *held->content, deletion)) {
    ++counters_.outdated;
    return {};
  }
  tuple_events out;
  const tuple_store::source by{tuple_store::origin::held, source};
  const bool room = deletion || (!full(x->name, source) && store_.admits(*x, by));
  counters_.overflow += room ? 0 : 1;
  if ((deletion || !room) && held != nullptr) { // better none than one that its owner has replaced
    incomplete_.erase({source, x->name.folded()});
    tell_deleted(store_.remove(source, x->name), out);
  } else if (room && acquainted(source, now)) {
    check_completeness(*x);
    tell_changed(store_.put(std::move(*x), expiry, by), out);
  }
  return out;
}

/// Local subscriptions and callbacks that a tuple concerns, in the order of their ids.
std::vector<subscription_id> tuple_space::interested(const tuple& x) const {
  std::vector<subscription_id> ids;
  wanted_.for_matching(x.name, [&](const subscription& s) {
    if (s.wanted.matches(x))
      ids.push_back(s.id);
  });
  std::sort(ids.begin(), ids.end());
  return ids;
}

bool tuple_space::wanted(const tuple& x) const {
  bool found = false;
  wanted_.for_matching(x.name, [&](const subscription& s) {
    found = found || (s.kind == interest::subscription && s.wanted.matches(x));
  });
  return found;
}

void tuple_space::tell_changed(const tuple_pointer& x, tuple_events& out) const {
  for (const auto id : interested(*x))
    out.push_back(tuple_changed{id, x});
}

void tuple_space::tell_deleted(const tuple_pointer& x, tuple_events& out) const {
  for (const auto id : interested(*x))
    out.push_back(tuple_deleted{id, x});
}

tuple_events tuple_space::on_time(instant now) {
  tuple_events out;
  while (const auto gone = store_.take_expired(now)) {
    ++counters_.expired;
    if (gone->owner == self_)
      forget_own(*gone);
    else
      incomplete_.erase({gone->owner, gone->name.folded()});
    tell_deleted(gone, out);
  }
  if (next_stranger_ && *next_stranger_ <= now)
    forget_strangers(now, out);
  if (next_orphan_ && *next_orphan_ <= now)
    remove_orphans(now, out);
  if (next_refresh_ && *next_refresh_ <= now)
    refresh(now, out);
  if (next_repair_ && *next_repair_ <= now)
    repair_appends(now, out);
  if (next_work_ && *next_work_ <= now)
    work(now, out);
  return out;
}

std::optional<instant> tuple_space::deadline() const {
  const auto of_others = earliest(next_stranger_, next_orphan_);
  const auto soon = earliest(earliest(store_.deadline(), next_repair_), next_work_);
  return earliest(soon, earliest(of_others, next_refresh_));
}

tuple_pointer tuple_space::find(peer_id owner, const key& name) const {
  const auto* x = store_.find(owner, name);
  return x != nullptr ? x->content : nullptr;
}

tuple_counters tuple_space::counters() const {
  auto all = counters_;
  all.tuples = store_.size();
  all.subscriptions = subscriptions_.size();
  all.subscribers = subscribers_.size();
  all.subscribers_octets = subscribers_.octets();
  all.held_octets = store_.held().total();
  all.written_octets = store_.written().total();
  all.pushes_octets = window_.octets();
  all.debtors = debts_.size();
  return all;
}

} // namespace rubicon::peis
