#include "peis/space/held_tuples.hpp"

#include <algorithm>

#include "peis/tuples/tuple_append.hpp"

namespace rubicon::peis {

held_tuples::held_tuples(const tuple_space_config& config, peer_id self, tuple_store& store,
                         tuple_hosts& hosts, const local_subscriptions& local,
                         const tuple_clock& clock)
    : config_(config), self_(self), store_(store), hosts_(hosts), local_(local), clock_(clock) {}

bool held_tuples::is_full(const key& name, peer_id owner) const {
  return store_.size() >= config_.tuples_max && store_.find(owner, name) == nullptr;
}

/// Does a pushed tuple replace the one held? A number restarts at zero when a real owner restarts
/// or creates the tuple anew, hence the time (peis-wire.md 15.3); a deletion that was overtaken by
/// a newer value must not remove it. What was asked for because ours is incomplete or stale has
/// the same number and time.
bool held_tuples::replaces(const tuple& x, const tuple& held, bool deletion) const {
  if (x.written > held.written)
    return true;
  if (x.seqno > held.seqno)
    return !deletion || x.written == held.written;
  const bool asked_for = held.stale || incomplete_.contains(key_of(held));
  return asked_for && x.seqno == held.seqno && x.written == held.written;
}

void held_tuples::remove(const tuple& held, tuple_events& out) {
  incomplete_.erase(key_of(held));
  local_.notify_deleted(store_.remove(held.owner, held.name), out);
}

void held_tuples::on_push(peer_id source, const payload& octets, instant now, tuple_events& out) {
  ++counters_.pushes_received;
  auto x = decode_tuple_message(octets, clock_.network_time(now));
  if (!x || x->owner != source || source == self_) {
    ++counters_.malformed;
    return;
  }
  const auto expiry = clock_.expiry_of(*x);
  const bool deletion = expiry && *expiry <= now;
  const auto held = store_.content(source, x->name);
  if (!local_.wants(deletion && held ? *held : *x)) {
    ++counters_.unwanted;
    return;
  }
  if (held ? !replaces(*x, *held, deletion) : deletion) {
    ++counters_.outdated;
    return;
  }
  const tuple_store::source by{tuple_store::origin::held, source};
  const bool room = deletion || (!is_full(x->name, source) && store_.admits(*x, by));
  counters_.overflow += room ? 0 : 1;
  if ((deletion || !room) && held) {
    remove(*held, out);
  } else if (room && hosts_.admit(source, now)) {
    check_completeness(*x);
    local_.notify_changed(store_.put(std::move(*x), expiry, by), out);
  }
}

void held_tuples::on_append_notice(peer_id source, const payload& octets, instant now,
                                   tuple_events& out) {
  ++counters_.append_notices_received;
  const auto notice = decode_append_notice(octets);
  if (!notice || notice->owner != source || source == self_) {
    ++counters_.malformed;
    return;
  }
  const auto held = store_.content(source, notice->name);
  if (!held || !local_.wants(*held)) {
    ++counters_.unwanted;
    return;
  }
  const bool same_set = notice->seqno == held->seqno;
  if (notice->seqno < held->seqno || (same_set && notice->length < held->value.size())) {
    ++counters_.outdated; // what we hold has it already
    return;
  }
  const auto size = notice->length - (held->form == encoding::text && notice->length > 0 ? 1 : 0) +
                    notice->added.size();
  if (!same_set || notice->length != held->value.size())
    note_gap(*notice, size, now, out);
  else if (size > tuple_value_max)
    ++counters_.overflow;
  else
    append(*held, notice->added, notice->append_seqno, out);
}

/// @param append_seqno of the notice
void held_tuples::append(const tuple& held, const payload& added, std::int32_t append_seqno,
                         tuple_events& out) {
  auto next = held;
  next.value = appended_value(held, added);
  work_.add(next.value.size() / append_octets_per_unit);
  next.append_seqno = append_seqno == INT32_MAX ? 0 : append_seqno + 1;
  const auto expiry = clock_.expiry_of(next);
  const tuple_store::source by{tuple_store::origin::held, held.owner};
  if (store_.admits(next, by)) {
    local_.notify_changed(store_.put(std::move(next), expiry, by), out);
  } else {
    ++counters_.overflow;
    remove(held, out);
  }
}

/// Something has not arrived: asks the owner for the whole value, by a subscription.
/// @param size of the value that has this append
void held_tuples::note_gap(const append_notice& notice, std::size_t size, instant now,
                           tuple_events& out) {
  ++counters_.append_gaps;
  const auto [at, first] = incomplete_.try_emplace({notice.owner, notice.name.folded()});
  auto& x = at->second;
  if (first || notice.seqno > x.seqno)
    x = {notice.name, notice.seqno, size, x.asked, first ? now : x.ask_again};
  else
    x.size = std::max(x.size, size);
  next_repair_ = earliest(next_repair_, x.ask_again);
  if (first)
    repair(now, out);
}

void held_tuples::check_completeness(const tuple& pushed) {
  const auto at = incomplete_.find(key_of(pushed));
  if (at == incomplete_.end())
    return;
  const auto& x = at->second;
  if (pushed.seqno > x.seqno || (pushed.seqno == x.seqno && pushed.value.size() >= x.size))
    incomplete_.erase(at);
}

void held_tuples::on_time(instant now, tuple_events& out) {
  if (next_repair_ && *next_repair_ <= now)
    repair(now, out);
}

void held_tuples::repair(instant now, tuple_events& out) {
  next_repair_.reset();
  for (auto at = incomplete_.begin(); at != incomplete_.end();) {
    auto& x = at->second;
    const auto owner = at->first.first;
    const auto* host = hosts_.find(owner);
    if (x.ask_again <= now && (x.asked >= config_.repairs_max || host == nullptr)) {
      ++counters_.append_gaps_given_up;
      at = incomplete_.erase(at);
      continue;
    }
    if (x.ask_again <= now) {
      ++x.asked;
      x.ask_again = now + config_.repair_append;
      out.push_back(local_.request_to(owner, host->marked, prototype_of(owner, x.name), false));
    }
    next_repair_ = earliest(next_repair_, x.ask_again);
    ++at;
  }
}

void held_tuples::on_owner_gone(peer_id owner, tuple_events& out) {
  for (const auto& x : store_.find_all(prototype_of(owner, key()))) {
    const bool keep = config_.keep_values_of_dead_hosts;
    if (keep && store_.held().total() <= config_.stale_octets_max) {
      auto last = *x;
      last.stale = true;
      const auto expiry = clock_.expiry_of(last);
      local_.notify_changed(store_.put(std::move(last), expiry, {tuple_store::origin::held, owner}),
                            out);
    } else {
      counters_.stale_removed += keep ? 1 : 0;
      local_.notify_deleted(store_.remove(owner, x->name), out);
    }
  }
  incomplete_.erase(incomplete_.lower_bound({owner, {}}),
                    incomplete_.lower_bound({peer_id{owner.value + 1}, {}}));
}

void held_tuples::on_expired(const tuple& gone) {
  incomplete_.erase(key_of(gone));
}

void held_tuples::on_unsubscribed(const prototype& unwanted) {
  for (const auto& x : store_.find_all(prototype_of(unwanted.owner, unwanted.name))) {
    if (x->owner != self_ && !local_.wants(*x)) {
      incomplete_.erase(key_of(*x));
      static_cast<void>(store_.remove(x->owner, x->name));
    }
  }
}

} // namespace rubicon::peis
