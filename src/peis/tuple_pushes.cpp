// What others are told of our tuples and asked for, as far as there is room: the newest value only
// (TUP-18), a piece of a long answer at a time.
#include <algorithm>
#include <deque>
#include <utility>

#include "peis/package.hpp"
#include "peis/tuple_space.hpp"

namespace rubicon::peis {

namespace {

// Work in steps of about a quarter of a microsecond: one for a tuple that is looked at.
constexpr std::size_t push_steps = 8;           ///< a message more
constexpr std::size_t visit_steps = 4;          ///< a host that is looked at
constexpr std::size_t slice_steps = 512;        ///< at once for one host
constexpr std::size_t turn_steps = 4096;        ///< at once for all
constexpr std::size_t steps_per_unit = 4;       ///< of what a neighbour is charged
constexpr duration turn_gap = 1ms;              ///< then others have their turn
constexpr duration room_check = 100ms;          ///< after there was no room for anybody
constexpr std::size_t missed_total_factor = 64; ///< of the limit for one host
constexpr std::size_t missed_unreached_max = 4; ///< by a host that nobody knows

transmit push_message(const tuple& x, peer_id subscriber) {
  return {subscriber,
          port::push,
          {encode_tuple_head(x, tuple_message_kind::push), encode_tuple_value(x)},
          no_request,
          x.from};
}

std::size_t message_size(const tuple& x) {
  return tuple_record_size + x.mimetype.size() + std::max<std::size_t>(1, x.value.size());
}

void take(std::size_t& steps, std::size_t some) {
  steps -= std::min(steps, some);
}

} // namespace

/// Each once, however many of its subscriptions match. A deletion concerns those too who asked for
/// a certain value.
std::vector<peer_id> tuple_space::subscribers_of(const tuple& x) const {
  std::vector<peer_id> hosts;
  subscribers_.for_matching(x.name, [&](const subscriber& s) {
    if (x.expiry == deleted || s.wanted.matches(x))
      hosts.push_back(s.host);
  });
  std::sort(hosts.begin(), hosts.end());
  hosts.erase(std::unique(hosts.begin(), hosts.end()), hosts.end());
  return hosts;
}

/// Gives a message a request of ours, by which we learn what became of it.
transmit tuple_space::in_flight(transmit message, std::optional<std::uint64_t> serial,
                                std::optional<instant> failing_since) {
  message.request =
      window_.leave({message.destination, message.content.size(), serial, failing_since});
  return message;
}

void tuple_space::push(const tuple& x, instant now, tuple_events& out) {
  const auto hosts = subscribers_of(x);
  if (hosts.empty())
    return;
  work_.add(hosts.size() / 2);
  const auto message = push_message(x, hosts.front());
  for (const auto host : hosts) {
    if (auto* unreached = waiting_for_way(host, now)) {
      miss_unreached(host, *unreached, x);
      continue;
    }
    if (!window_.admits(host, message.content.size())) {
      ++counters_.pushes_deferred;
      miss(host, x.name.folded(), std::nullopt);
      settle(debts_.find(host), now);
      continue;
    }
    ++counters_.pushes_sent;
    if (const auto debtor = debts_.find(host); debtor != debts_.end()) {
      const auto overtaken = debtor->second.missed.erase(x.name.folded());
      missed_ -= overtaken;
      counters_.pushes_overtaken += overtaken;
    }
    auto to_host = message;
    to_host.destination = host;
    out.push_back(in_flight(std::move(to_host), {}, {}));
  }
}

/// The debt of a host that nobody knows and that has just not been reached. It is tried again in
/// its time, however many values change meanwhile. Null for any other.
tuple_space::debt* tuple_space::waiting_for_way(peer_id host, instant now) {
  if (hosts_.contains(host))
    return nullptr;
  const auto at = debts_.find(host);
  const bool waits = at != debts_.end() && at->second.not_before && *at->second.not_before > now;
  return waits ? &at->second : nullptr;
}

/// A few values are kept in mind one by one. Then all is looked at when there is a way, from its
/// beginning, and a change costs nothing until then.
void tuple_space::miss_unreached(peer_id host, debt& x, const tuple& changed) {
  const bool all_is_owed = !x.walks.empty() && x.after.empty();
  if (all_is_owed) {
    ++counters_.pushes_overtaken;
    counters_.pushes_given_up += changed.expiry == deleted ? 1 : 0; // no walk finds it
  } else if (x.missed.size() < missed_unreached_max) {
    miss(host, changed.name.folded(), std::nullopt);
  } else {
    resynchronise(host, x);
    x.after.clear();
  }
}

/// The newest value of a tuple, or that it is gone, is to be sent to a host later. Who misses too
/// many is not told one by one: all that he wants is looked at again.
void tuple_space::miss(peer_id host, const std::string& folded,
                       std::optional<instant> failing_since) {
  auto& x = debts_[host];
  const auto [at, first] = x.missed.try_emplace(folded, failing_since);
  if (!first) {
    at->second = at->second ? at->second : failing_since;
    ++counters_.pushes_overtaken;
  }
  missed_ += first ? 1 : 0;
  const auto total_max = missed_total_factor * config_.missed_max;
  const bool many_in_all = missed_ > total_max && x.missed.size() > missed_ / debts_.size();
  if (x.missed.size() > config_.missed_max || many_in_all)
    resynchronise(host, x);
}

bool tuple_space::is_waiting(const key& name) const {
  const auto* held = store_.find(self_, name);
  if (held == nullptr || debts_.empty())
    return false;
  return std::ranges::any_of(subscribers_of(*held->content), [&](peer_id host) {
    const auto owed = debts_.find(host);
    return owed != debts_.end() &&
           (owed->second.missed.contains(name.folded()) || !owed->second.walks.empty());
  });
}

/// Tries again when somebody may have found a way to that host.
void tuple_space::miss_for_now(peer_id host, const key& name, instant failing_since, instant now) {
  miss(host, name.folded(), failing_since);
  auto& x = debts_[host];
  x.not_before = now + config_.retry_push;
  plan(host, x, x.not_before);
}

/// All that it wants is to be looked at.
void tuple_space::resynchronise(peer_id host, debt& x) {
  ++counters_.resyncs;
  std::size_t gone = 0;
  for (const auto& [folded, since] : x.missed) {
    const auto name = key::from_wire(folded);
    gone += name && store_.find(self_, *name) == nullptr ? 1 : 0;
  }
  counters_.pushes_given_up += gone; // deletions: no walk finds them
  missed_ -= x.missed.size();
  x.missed.clear();
  if (const auto* all = subscribers_.of(host)) {
    for (const auto& [number, s] : *all)
      owe_walk(*s);
  }
}

void tuple_space::ask_all(peer_id host, bool refresh) {
  auto& x = debts_[host];
  if (x.ask)
    x.ask_again = x.ask_again.value_or(true) && refresh;
  else
    x.ask = debt::asking{0, refresh};
}

/// All that matches is to be sent; what is in flight goes to its end first, and then begins again.
void tuple_space::owe_walk(subscriber& x) {
  if (!debts_[x.host].walks.emplace(x.number, &x).second)
    x.again = true;
}

void tuple_space::forget_walk(peer_id host, std::uint64_t number) {
  const auto at = debts_.find(host);
  if (at == debts_.end() || !at->second.walks.contains(number))
    return;
  if (at->second.walks.begin()->first == number)
    at->second.after.clear();
  at->second.walks.erase(number);
}

tuple tuple_space::deletion_of(const key& name, instant now) const {
  tuple x;
  x.owner = x.creator = self_;
  x.name = name;
  x.seqno = first_seqno_ - 1; // no less than any deletion has had
  x.written = network_time(now);
  x.expiry = deleted;
  x.value = payload(bytes{0});
  return x;
}

bool tuple_space::blocked(peer_id host, debt& x, std::size_t octets, instant now) const {
  if (window_.admits(host, octets))
    return false;
  if (window_.idle(host)) // nothing of its own will tell when there is room
    x.not_before = now + room_check;
  return true;
}

/// @returns whether the host has been asked everything
bool tuple_space::ask_on(peer_id host, debt& x, std::size_t& steps, instant now,
                         tuple_events& out) {
  const auto known = hosts_.find(host);
  if (known == hosts_.end()) {
    x.ask.reset();
    x.ask_again.reset();
    x.asked_in_vain.clear();
    return true;
  }
  const auto ask = [&](const question& q, bool refresh) {
    take(steps, push_steps);
    out.push_back(
        in_flight(subscribe_message_to(host, known->second, q.wanted, refresh), q.serial, {}));
  };
  while (x.ask || !x.asked_in_vain.empty()) {
    if (steps == 0 || blocked(host, x, 2 * tuple_record_size, now))
      return false;
    take(steps, 1);
    if (!x.asked_in_vain.empty()) {
      const auto at = questions_by_serial_.find(*x.asked_in_vain.begin());
      x.asked_in_vain.erase(x.asked_in_vain.begin());
      if (at != questions_by_serial_.end())
        ask(*at->second, false);
      continue;
    }
    const auto at = questions_by_serial_.lower_bound(x.ask->next);
    if (at == questions_by_serial_.end()) {
      x.ask.reset();
      if (const auto refresh = std::exchange(x.ask_again, std::nullopt))
        x.ask = debt::asking{0, *refresh};
      continue;
    }
    x.ask->next = at->first + 1;
    if (const auto owner = at->second->wanted.owner; owner == any_peer || owner == host)
      ask(*at->second, x.ask->refresh);
  }
  return true;
}

/// @returns whether nothing is missing any more
bool tuple_space::repeat_missed(peer_id host, debt& x, std::size_t& steps, instant now,
                                tuple_events& out) {
  while (!x.missed.empty()) {
    if (steps == 0)
      return false;
    take(steps, 1);
    auto at = x.missed.upper_bound(x.missed_after); // in turns: none waits for those before it
    at = at == x.missed.end() ? x.missed.begin() : at;
    const auto name = key::from_wire(at->first);
    const auto* held = store_.find(self_, *name);
    const auto content = held != nullptr ? *held->content : deletion_of(*name, now);
    const bool given_up = at->second && now - *at->second > config_.give_up_push;
    const bool overtaken = channels_.busy(*name, host); // by a whole value, with appends
    const bool needed = !given_up && !overtaken && has_subscribed(host, content);
    if (needed && blocked(host, x, message_size(content), now))
      return false;
    const auto failing_since = at->second;
    x.missed_after = at->first;
    x.missed.erase(at);
    --missed_;
    counters_.pushes_given_up += given_up ? 1 : 0;
    if (!needed)
      continue;
    take(steps, push_steps);
    ++counters_.pushes_retried;
    out.push_back(in_flight(push_message(content, host), {}, failing_since));
  }
  return true;
}

void tuple_space::push_walked(peer_id host, const key& name, instant now, tuple_events& out) {
  if (channels_.busy(name, host))
    collapse(name, now); // what is in flight would be applied to a value that has it already
  ++counters_.pushes_sent;
  auto message = push_message(*store_.find(self_, name)->content, host);
  if (channels_.follows(name))
    transmit_in_order(name, std::move(message), out);
  else
    out.push_back(in_flight(std::move(message), {}, {}));
}

/// @returns whether all walks have come to their end
bool tuple_space::walk_on(peer_id host, debt& x, std::size_t& steps, instant now,
                          tuple_events& out) {
  while (!x.walks.empty()) {
    auto& s = *x.walks.begin()->second;
    auto wanted = s.wanted;
    wanted.owner = self_; // for the search only
    const bool through = store_.walk_on(self_, wanted.name, x.after, [&](const auto& entry) {
      if (steps == 0)
        return false;
      take(steps, 1);
      if (!wanted.matches(*entry.content))
        return true;
      if (blocked(host, x, message_size(*entry.content), now))
        return false;
      take(steps, push_steps);
      push_walked(host, key(entry.content->name), now, out);
      return true;
    });
    if (!through)
      return false;
    x.after.clear();
    if (!std::exchange(s.again, false))
      x.walks.erase(x.walks.begin());
    else if (steps == 0)
      return false;
    take(steps, 1);
  }
  return true;
}

/// Sends what is due to a host, until there is no room, nothing left or no step.
void tuple_space::serve(peer_id host, debt& x, std::size_t& steps, instant now, tuple_events& out) {
  if (x.not_before && *x.not_before > now)
    return;
  x.not_before.reset();
  const auto before = steps;
  if (ask_on(host, x, steps, now, out) && repeat_missed(host, x, steps, now, out))
    static_cast<void>(walk_on(host, x, steps, now, out));
  counters_.steps += before - steps;
}

/// A debt is looked at then, or not until something else happens.
void tuple_space::plan(peer_id host, debt& x, std::optional<instant> due) {
  if (x.due == due)
    return;
  if (x.due)
    agenda_.erase({*x.due, host});
  x.due = due;
  if (due) {
    agenda_.emplace(*due, host);
    next_work_ = earliest(next_work_, due);
  }
}

/// Forgets a debt that is paid, or says when it is looked at again; one whose turn is near keeps
/// it.
void tuple_space::settle(debts::iterator at, instant now) {
  auto& [host, x] = *at;
  if (x.settled()) {
    plan(host, x, std::nullopt);
    debts_.erase(at);
    return;
  }
  if (x.not_before && *x.not_before > now)
    plan(host, x, x.not_before);
  else if (window_.admits(host, tuple_record_size))
    plan(host, x, earliest(x.due, now + turn_gap));
  else if (window_.idle(host))
    plan(host, x, earliest(x.due, now + room_check));
}

/// Does a first piece at once, unless others are being served: then its turn comes.
void tuple_space::serve_now(peer_id host, instant now, tuple_events& out) {
  const auto at = debts_.find(host);
  if (at == debts_.end())
    return;
  const bool turn_is_near = next_work_ && *next_work_ <= now + turn_gap;
  if (!turn_is_near) {
    auto steps = slice_steps;
    serve(host, at->second, steps, now, out);
    work_.add((slice_steps - steps) / steps_per_unit);
  }
  settle(at, now);
}

/// One turn of deferred work: who has waited longest first, a slice each, round and round.
void tuple_space::work(instant now, tuple_events& out) {
  auto steps = turn_steps;
  std::deque<peer_id> again; // had a slice and want another
  const auto next = [&]() -> std::optional<peer_id> {
    auto host = again.empty() ? std::nullopt : std::optional(again.front());
    if (!agenda_.empty() && agenda_.begin()->first <= now)
      host = agenda_.begin()->second;
    else if (host)
      again.pop_front();
    return host;
  };
  for (auto host = next(); host; host = steps > 0 ? next() : std::nullopt) {
    const auto at = debts_.find(*host);
    plan(*host, at->second, std::nullopt);
    auto slice = std::min(steps, slice_steps);
    const auto before = slice;
    serve(*host, at->second, slice, now, out);
    take(steps, before - slice + visit_steps);
    if (slice == 0)
      again.push_back(*host);
    else
      settle(at, now);
  }
  for (const auto host : again)
    settle(debts_.find(host), now);
  next_work_.reset();
  if (!agenda_.empty())
    next_work_ = std::max(agenda_.begin()->first, now + turn_gap);
}

tuple_events tuple_space::on_delivered(request_id request, instant now) {
  tuple_events out;
  if (const auto x = window_.finish(request, true))
    serve_now(x->host, now, out);
  else if (auto next = channels_.on_delivered(request))
    out.push_back(std::move(*next));
  return out;
}

void tuple_space::on_undelivered(peer_id destination, std::uint16_t port, byte_view head,
                                 request_id request, instant now) {
  const auto x = window_.finish(request, false);
  const bool of_channel = channels_.knows(request);
  if (!x && !of_channel)
    return; // of a host that is gone, or of somebody else
  const bool concerns_tuple = port == port::push || port == port::append_notice;
  const auto name = concerns_tuple ? decode_record_key(head) : result<key>(errc::unsupported);
  if (name && of_channel)
    collapse(*name, now);
  if (name) { // also to a host whose way is not known yet
    miss_for_now(destination, *name, x && x->failing_since ? *x->failing_since : now, now);
  } else if (x && x->question && hosts_.contains(destination)) {
    auto& to = debts_[destination];
    to.asked_in_vain.insert(*x->question);
    to.not_before = now + config_.retry_push;
    plan(destination, to, to.not_before);
  }
}

} // namespace rubicon::peis
