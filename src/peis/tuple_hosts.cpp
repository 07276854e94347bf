// What other hosts leave in a tuple space when they go, and what they may do before anybody knows
// them (TUP-19, P2P-09).
#include <algorithm>
#include <iterator>
#include <utility>

#include "peis/tuple_space.hpp"

namespace rubicon::peis {

namespace {

constexpr std::size_t dormant_hosts_max = 64;
constexpr std::size_t dormant_subscriptions_max = 256;            // of one host
constexpr std::size_t dormant_octets_max = std::size_t{1} << 18U; // of one host

} // namespace

tuple_events tuple_space::on_host_vanished(peer_id host, instant now) {
  tuple_events out;
  lay_down(host);
  hosts_.erase(host);
  strangers_.erase(host);
  forget_host(host, now, out);
  return out;
}

void tuple_space::lay_down(peer_id host) {
  const auto known = hosts_.find(host);
  const auto* all = subscribers_.of(host);
  if (all == nullptr || known == hosts_.end() || known->second.marked ||
      known->second.incarnation == 0)
    return;
  dormant_host x{known->second.incarnation, {}};
  std::size_t octets = 0;
  for (const auto& [number, s] : *all) {
    octets += s->weight;
    if (x.wanted.size() >= dormant_subscriptions_max || octets > dormant_octets_max)
      break;
    if (!s->expiry)
      x.wanted.push_back(s->wanted);
  }
  if (x.wanted.empty())
    return;
  if (dormant_.size() >= dormant_hosts_max && !dormant_.contains(host)) {
    dormant_.erase(dormant_.begin());
    ++counters_.absent_forgotten;
  }
  dormant_[host] = std::move(x);
}

/// What it had subscribed to when it was given up, if it has not begun anew since.
void tuple_space::wake_up(peer_id host, std::int32_t incarnation, instant now, tuple_events& out) {
  const auto rested = dormant_.extract(host);
  if (rested.empty() || rested.mapped().incarnation != incarnation)
    return;
  for (const auto& wanted : rested.mapped().wanted) {
    auto pushes = on_subscribe(host, encode(subscribe_message{wanted, std::nullopt}), now);
    std::move(pushes.begin(), pushes.end(), std::back_inserter(out));
  }
}

/// What it has put here goes; what it wrote into our own tuples stays for a while (orphans).
void tuple_space::forget_host(peer_id host, instant now, tuple_events& out) {
  for (const auto& x : store_.find_all(prototype_of(host, key()))) {
    const bool keep = config_.keep_values_of_dead_hosts;
    if (keep && store_.held().total() <= config_.stale_octets_max) {
      auto last = *x;
      last.stale = true;
      const auto expiry = expiry_of(last);
      tell_changed(store_.put(std::move(last), expiry, {tuple_store::origin::held, host}), out);
    } else {
      counters_.stale_removed += keep ? 1 : 0;
      tell_deleted(store_.remove(host, x->name), out);
    }
  }
  if (subscribers_.erase_host(host) > 0)
    ++subscribers_version_;
  if (const auto owed = debts_.find(host); owed != debts_.end()) {
    missed_ -= owed->second.missed.size();
    plan(host, owed->second, std::nullopt);
    debts_.erase(owed);
  }
  window_.drop(host);
  incomplete_.erase(incomplete_.lower_bound({host, {}}),
                    incomplete_.lower_bound({peer_id{host.value + 1}, {}}));
  channels_.drop_subscriber(host);
  if (store_.written().of(host) > 0 && !next_orphan_)
    next_orphan_ = now + config_.orphan_age;
}

/// Whoever has put something here is known to the network, or has a place among those who may
/// become known: a kernel subscribes as soon as it hears of us (P2P-09).
bool tuple_space::acquainted(peer_id source, instant now) {
  if (hosts_.contains(source))
    return true;
  if (!strangers_.contains(source) && strangers_.size() >= config_.strangers_max) {
    ++counters_.strangers_refused;
    return false;
  }
  strangers_[source] = now;
  next_stranger_ = earliest(next_stranger_, now + config_.stranger_age);
  return true;
}

void tuple_space::forget_strangers(instant now, tuple_events& out) {
  next_stranger_.reset();
  for (auto at = strangers_.begin(); at != strangers_.end();) {
    const auto [host, heard] = *at;
    const auto until = heard + config_.stranger_age;
    at = until <= now ? strangers_.erase(at) : std::next(at);
    if (until <= now)
      forget_host(host, now, out);
    else
      next_stranger_ = earliest(next_stranger_, until);
  }
}

/// A tuple outlives its writer (peis-wire.md 15.3): a command is obeyed after the planner has gone.
/// That much of it is kept as no planner needs; the largest of what they have created go beyond.
void tuple_space::remove_orphans(instant now, tuple_events& out) {
  next_orphan_.reset();
  std::vector<std::pair<std::size_t, key>> found;
  std::size_t octets = 0;
  const auto here = [&](peer_id x) { return hosts_.contains(x) || strangers_.contains(x); };
  if (store_.written().total() > config_.orphaned_octets_max) {
    store_.for_matching(prototype_of(self_, key()), [&](const tuple_store::entry& x) {
      if (!x.created_by_other || here(x.by.host))
        return;
      found.emplace_back(x.weight, x.content->name);
      octets += x.weight;
    });
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  for (const auto& [weight, name] : found) {
    if (octets <= config_.orphaned_octets_max)
      break;
    octets -= weight;
    ++counters_.orphans_removed;
    auto told = remove(name, now);
    std::move(told.begin(), told.end(), std::back_inserter(out));
  }
}

} // namespace rubicon::peis
