// Appending to tuples (peis-wire.md 15.5, TUP-07). A subscriber can check that a notice fits: it
// tells the number of the set and the length of the value before it. (The number of the append
// would tell it too, but real kernels begin it with garbage.)
#include <algorithm>

#include "peis/package.hpp"
#include "peis/tuple_space.hpp"

namespace rubicon::peis {

namespace {

constexpr std::size_t appends_look_at_max = 8192; ///< tuples, for one request of another
constexpr std::size_t copied_per_unit = 4096;     ///< octets, for a unit of work

/// Octets of a value that an append keeps: all but the trailing NUL of text.
std::size_t kept(const tuple& x) {
  return x.value.size() - (x.form == encoding::text && !x.value.empty() ? 1 : 0);
}

payload joined(const tuple& x, const payload& added) {
  const auto head = x.value.view().first(kept(x));
  const auto tail = added.view();
  bytes all;
  all.reserve(head.size() + tail.size());
  all.insert(all.end(), head.begin(), head.end());
  all.insert(all.end(), tail.begin(), tail.end());
  return all;
}

bool ends_with_nul(const payload& x) {
  return !x.empty() && x.view().back() == 0;
}

payload with_nul(const payload& x) {
  auto octets = to_bytes(x.view());
  octets.push_back(0);
  return octets;
}

} // namespace

std::pair<cause, tuple_events> tuple_space::append(const prototype& wanted, const payload& added,
                                                   instant now) {
  tuple_events out;
  auto why = cause::none;
  auto own = wanted;
  own.owner = self_;
  for (const auto& x : store_.find_all(own)) {
    const auto by = store_.find(self_, x->name)->by;
    if (const auto failed = append_to(x, added, by, now, out); failed != cause::none)
      why = failed;
  }
  return {why, std::move(out)};
}

/// Those that another may append to; nothing if it asks for too many, or too many have to be looked
/// at for it.
std::optional<std::vector<tuple_pointer>> tuple_space::matches_for_other(const prototype& wanted) {
  std::vector<tuple_pointer> found;
  std::string after;
  std::size_t looked_at = 0;
  const bool through = store_.walk_on(self_, wanted.name, after, [&](const auto& x) {
    const bool matches = wanted.matches(*x.content);
    if (matches && is_reserved(x.content->name))
      ++counters_.refused;
    else if (matches)
      found.push_back(x.content);
    return ++looked_at <= appends_look_at_max && found.size() <= config_.append_matches_max;
  });
  work_.add(looked_at / 2);
  return through ? std::optional(std::move(found)) : std::nullopt;
}

cause tuple_space::append_to(const tuple_pointer& held, const payload& added,
                             tuple_store::source by, instant now, tuple_events& out) {
  const bool text = held->form == encoding::text;
  const bool by_other = by.from == tuple_store::origin::written;
  const auto tail = text && !ends_with_nul(added) ? with_nul(added) : added;
  const auto size = kept(*held) + tail.size();
  if (size > tuple_value_max) {
    ++counters_.overflow;
    return cause::too_long;
  }
  auto next = *held;
  if (text && !held->value.empty() && !ends_with_nul(held->value))
    next.value = with_nul(held->value); // or its last character would be lost
  const bool notify = next.value.size() == held->value.size() && can_notify(*held);
  next.value = joined(next, tail);
  work_.add(size / copied_per_unit);
  if (by_other && !store_.admits(next, by)) {
    ++counters_.overflow;
    return cause::space_full;
  }
  ++counters_.appends;
  if (notify)
    append_notified(*held, std::move(next), tail, by, now, out);
  else
    append_whole(std::move(next), by, out);
  return cause::none;
}

/// May subscribers be told the added octets only? Not before everybody has been sent a whole value
/// whose arrival is watched; not if somebody asked for certain values; an empty value travels in a
/// form that nothing can be added to.
bool tuple_space::can_notify(const tuple& held) const {
  bool all_want_it = true;
  subscribers_.for_matching(held.name, [&](const subscriber& s) {
    all_want_it = all_want_it && !s.wanted.value && s.wanted.matches(held);
  });
  return all_want_it && channels_.follows(held.name) && !held.value.empty();
}

void tuple_space::append_whole(tuple next, tuple_store::source by, tuple_events& out) {
  static_cast<void>(channels_.abandon(next.name));
  if (next.mimetype == empty_mimetype)
    next.mimetype = next.form == encoding::text ? text_mimetype : binary_mimetype;
  ++next.seqno;
  next.append_seqno = 0;
  const auto stored = put_own(std::move(next), by);
  const auto hosts = subscribers_of(*stored);
  if (!hosts.empty())
    channels_.follow(stored->name);
  const message_octets content{encode_tuple_head(*stored, tuple_message_kind::push),
                               encode_tuple_value(*stored)};
  counters_.pushes_sent += hosts.size();
  for (const auto host : hosts)
    transmit_in_order(stored->name, {host, port::push, content, no_request}, out);
  tell_changed(stored, out);
}

void tuple_space::append_notified(const tuple& before, tuple next, const payload& added,
                                  tuple_store::source by, instant now, tuple_events& out) {
  ++next.append_seqno;
  const auto stored = put_own(std::move(next), by);
  const message_octets content{encode_append_notice_head(before, added.size()), added};
  std::vector<peer_id> overrun;
  for (const auto host : subscribers_of(*stored)) {
    if (channels_.full(stored->name, host, content.size())) {
      overrun.push_back(host);
      continue;
    }
    ++counters_.append_notices_sent;
    transmit_in_order(stored->name, {host, port::append_notice, content, no_request}, out);
  }
  tell_changed(stored, out);
  if (overrun.empty())
    return;
  collapse(stored->name, now);
  for (const auto host : overrun)
    miss_for_now(host, stored->name, now, now);
}

void tuple_space::transmit_in_order(const key& name, transmit message, tuple_events& out) {
  if (auto first = channels_.send(name, std::move(message)))
    out.push_back(std::move(*first));
}

/// Gives up what has not left yet. Those who miss it get the whole value soon, under a number of
/// its own: a holder of the current one would refuse it.
void tuple_space::collapse(const key& name, instant now) {
  const auto missing = channels_.abandon(name);
  ++counters_.appends_collapsed;
  if (const auto* held = store_.find(self_, name)) {
    const bool is_new = held->is_new;
    auto same = *held->content;
    ++same.seqno;
    same.append_seqno = 0;
    static_cast<void>(put_own(std::move(same), held->by));
    store_.find(self_, name)->is_new = is_new;
  }
  for (const auto host : missing)
    miss_for_now(host, name, now, now);
}

tuple_events tuple_space::on_append_request(peer_id source, const payload& octets, instant now) {
  const auto request = decode_append_request(octets, network_time(now));
  if (!request || request->wanted.owner != self_) {
    ++counters_.malformed;
    return {};
  }
  tuple_events out;
  const auto found = matches_for_other(request->wanted);
  if (!found) {
    ++counters_.appends_refused;
    return out;
  }
  if (found->empty() || !acquainted(source, now))
    return out;
  for (const auto& x : *found) {
    if (x->value.size() + request->added.size() > config_.append_octets_max)
      ++counters_.appends_refused;
    else
      static_cast<void>(
          append_to(x, request->added, {tuple_store::origin::written, source}, now, out));
  }
  return out;
}

tuple_events tuple_space::on_append_notice(peer_id source, const payload& octets, instant now) {
  ++counters_.append_notices_received;
  const auto notice = decode_append_notice(octets);
  if (!notice || notice->owner != source || source == self_) {
    ++counters_.malformed;
    return {};
  }
  tuple_events out;
  const auto held = find(source, notice->name);
  if (!held || !wanted(*held)) {
    ++counters_.unwanted;
    return out;
  }
  const bool same_set = notice->seqno == held->seqno;
  if (notice->seqno < held->seqno || (same_set && notice->length < held->value.size())) {
    ++counters_.outdated; // what we hold has it already
    return out;
  }
  const auto size = notice->length - (held->form == encoding::text && notice->length > 0 ? 1 : 0) +
                    notice->added.size();
  if (!same_set || notice->length != held->value.size()) {
    note_gap(source, notice->name, notice->seqno, size, now, out);
  } else if (size > tuple_value_max) {
    ++counters_.overflow;
  } else {
    auto next = *held;
    next.value = joined(*held, notice->added);
    work_.add(size / copied_per_unit);
    next.append_seqno = notice->append_seqno == INT32_MAX ? 0 : notice->append_seqno + 1;
    const auto expiry = expiry_of(next);
    const tuple_store::source by{tuple_store::origin::held, source};
    if (store_.admits(next, by)) {
      tell_changed(store_.put(std::move(next), expiry, by), out);
    } else {
      ++counters_.overflow;
      incomplete_.erase({source, held->name.folded()});
      tell_deleted(store_.remove(source, held->name), out);
    }
  }
  return out;
}

/// Something has not arrived: asks the owner for the whole value, by a subscription.
void tuple_space::note_gap(peer_id owner, const key& name, std::int32_t seqno, std::size_t size,
                           instant now, tuple_events& out) {
  ++counters_.append_gaps;
  const auto [at, first] = incomplete_.try_emplace({owner, name.folded()});
  auto& x = at->second;
  if (first || seqno > x.seqno)
    x = {name, seqno, size, x.asked, first ? now : x.ask_again};
  else
    x.size = std::max(x.size, size);
  next_repair_ = earliest(next_repair_, x.ask_again);
  if (first)
    repair_appends(now, out);
}

void tuple_space::check_completeness(const tuple& pushed) {
  const auto at = incomplete_.find({pushed.owner, pushed.name.folded()});
  if (at == incomplete_.end())
    return;
  const auto& x = at->second;
  if (pushed.seqno > x.seqno || (pushed.seqno == x.seqno && pushed.value.size() >= x.size))
    incomplete_.erase(at);
}

void tuple_space::repair_appends(instant now, tuple_events& out) {
  next_repair_.reset();
  for (auto at = incomplete_.begin(); at != incomplete_.end();) {
    auto& x = at->second;
    const auto owner = at->first.first;
    const auto host = hosts_.find(owner);
    if (x.ask_again <= now && (x.asked >= config_.repairs_max || host == hosts_.end())) {
      ++counters_.append_gaps_given_up;
      at = incomplete_.erase(at);
      continue;
    }
    if (x.ask_again <= now) {
      ++x.asked;
      x.ask_again = now + config_.repair_append;
      out.push_back(subscribe_message_to(owner, host->second, prototype_of(owner, x.name), false));
    }
    next_repair_ = earliest(next_repair_, x.ask_again);
    ++at;
  }
}

} // namespace rubicon::peis
