#include "smepp/events/event_management.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "network/wire.hpp"

namespace rubicon::smepp {

namespace {

using std::chrono::microseconds;

/// The number of the interval around the multiple of it that `x` is nearest to.
std::int64_t slot_of(const subscription& s, group_time x) {
  const duration since = x - s.made_at + std::chrono::floor<microseconds>(s.interval / 2);
  return since / s.interval;
}

subscribe message_of(const subscription& x, bool is_refresh) {
  return {x.id,      x.round,   x.depth,
          x.made_at, x.expires, static_cast<std::uint32_t>(x.interval / 1ms),
          x.name,    is_refresh};
}

} // namespace

event_management::event_management(event_config config, random_stream rng)
    : config_(config), rng_(rng), sequence_(static_cast<std::uint16_t>(rng_.next())),
      number_(static_cast<std::uint8_t>(rng_.next())) {}

const subscription* event_management::find(group_id group, subscription_id id) const {
  const auto found = std::ranges::find_if(
      subscriptions_, [&](const subscription& x) { return x.group == group && x.id == id; });
  return found == subscriptions_.end() ? nullptr : &*found;
}

subscription* event_management::find(group_id group, subscription_id id) {
  return const_cast<subscription*>(std::as_const(*this).find(group, id));
}

std::size_t event_management::count(group_id group) const {
  return static_cast<std::size_t>(std::ranges::count(subscriptions_, group, &subscription::group));
}

subscription_info event_management::info(const subscription& x, const group& g) {
  subscription_info info{x.id, x.name, std::nullopt, x.interval, g.sync.when(x.made_at)};
  if (x.expires != group_time_max)
    info.expires = g.sync.when(x.expires);
  return info;
}

// ---- the application

std::optional<failure> event_management::subscribe(const group& g, const std::string& name,
                                                   std::optional<duration> expiration, double rate,
                                                   context c) {
  const auto interval =
      rate > 0 ? std::chrono::milliseconds(std::llround(std::clamp(1000 / rate, 0.0, 4.0e9)))
               : std::chrono::milliseconds{};
  if (!is_name(name, event_name_max) || rate < 0 || !std::isfinite(rate) ||
      (rate > 0 && interval < 1ms) || (expiration && *expiration <= duration{}))
    return failure::bad_argument;
  const auto known = std::ranges::find_if(subscriptions_, [&](const subscription& x) {
    return x.group == g.id && x.depth == 0 && x.name == name;
  });
  if (known == subscriptions_.end() && subscriptions_.size() >= config_.subscriptions_max)
    return failure::no_room;
  subscription x;
  if (known != subscriptions_.end()) { // again: with other parameters
    x.is_received = known->is_received;
    remove(static_cast<std::size_t>(known - subscriptions_.begin()), true, c);
  }
  do {
    if (++number_ == 0)
      number_ = 1;
    x.id = {config_.self, number_};
  } while (find(g.id, x.id) != nullptr);
  x.group = g.id;
  x.name = name;
  x.made_at = g.sync.at(c.now);
  x.expires = group_time_max;
  if (expiration)
    x.expires = std::min(group_time_max, x.made_at + std::chrono::ceil<microseconds>(*expiration));
  x.interval = interval;
  x.refreshed_at = c.now;
  subscriptions_.push_back(x);
  spread(x, false, c);
  return std::nullopt;
}

std::optional<failure> event_management::unsubscribe(group_id group, const std::string& name,
                                                     context c) {
  bool is_any = false;
  for (std::size_t i = subscriptions_.size(); i-- > 0;) {
    const auto& x = subscriptions_[i];
    if (x.group != group || x.depth != 0 || (!name.empty() && x.name != name))
      continue;
    is_any = true;
    remove(i, true, c);
  }
  if (!is_any && !name.empty())
    return failure::bad_argument;
  return std::nullopt;
}

std::optional<failure> event_management::receive(group_id group, const std::string& name,
                                                 double frequency) {
  const auto found = std::ranges::find_if(subscriptions_, [&](const subscription& x) {
    return x.group == group && x.depth == 0 && x.name == name;
  });
  if (found == subscriptions_.end() || frequency < 0 || !std::isfinite(frequency))
    return failure::bad_argument;
  found->is_received = true;
  found->every = 1;
  if (frequency > 0 && found->interval > duration{}) {
    const auto windows = 1 / (frequency * seconds(found->interval));
    found->every = static_cast<std::uint32_t>(std::clamp(std::round(windows), 1.0, 1.0e6));
  }
  return std::nullopt;
}

std::optional<failure> event_management::event(const group& g, const std::string& name,
                                               const bytes& value, context c) {
  if (value.size() > event_value_max)
    return failure::bad_argument;
  const auto at = g.sync.at(c.now);
  for (auto& x : subscriptions_) {
    if (x.group != g.id || x.name != name || x.expires <= at)
      continue;
    if (x.interval > duration{}) {
      const auto slot = slot_of(x, at);
      if (x.last_slot && slot <= *x.last_slot) {
        ++counters_.suppressed;
        continue;
      }
      x.last_slot = slot;
    }
    ++counters_.raised;
    smepp::event raised{x.id, config_.self, ++sequence_, 0, std::nullopt, value};
    if (pairwise_.has(x.id.subscriber))
      if (const auto number = c.keys.unique())
        raised.proof = pairwise_.prove(raised, g.id, x.made_at, *number);
    if (x.depth == 0) {
      take(raised, x, true, c);
      continue;
    }
    const acting_on event(provenance::begin("message", x.id.subscriber.value));
    enqueue(g.id, std::move(raised), c);
  }
  pump(c);
  return std::nullopt;
}

// ---- trees

/// One round, as far as we are concerned.
void event_management::spread(const subscription& x, bool is_refresh, context c) const {
  if (x.depth >= config_.hops_max)
    return;
  to_send round{broadcast_mote, x.group, message_of(x, is_refresh)};
  round.copies = config_.flood_copies;
  c.out.push_back(round);
}

bool event_management::is_removed(group_id group, const smepp::subscribe& x) const {
  return std::ranges::any_of(removed_, [&](const removed& each) {
    return each.group == group && each.id == x.id && x.made_at <= each.made_at;
  });
}

void event_management::on_message(mote_id from, const smepp::subscribe& x, const group& g,
                                  context c) {
  if (x.id.subscriber == config_.self)
    return; // also what remains of a former life: it is not refreshed
  if (is_removed(g.id, x) || x.expires <= g.sync.at(c.now) || x.hops >= config_.hops_max)
    return drop("over");
  const auto depth = static_cast<std::uint8_t>(x.hops + 1);
  auto* known = find(g.id, x.id);
  if (known != nullptr && known->made_at < x.made_at) { // a new one with an old number
    remove(static_cast<std::size_t>(known - subscriptions_.data()), false, c);
    known = nullptr;
  }
  if (known == nullptr) {
    if (subscriptions_.size() >= config_.subscriptions_max)
      return drop("no_room");
    subscription added;
    added.group = g.id;
    added.id = x.id;
    added.name = x.name;
    added.made_at = x.made_at;
    added.expires = x.expires;
    added.interval = std::chrono::milliseconds(x.interval_ms);
    added.round = x.round;
    added.depth = depth;
    added.parent = from;
    added.refreshed_at = c.now;
    subscriptions_.push_back(added);
    c.out.push_back(signal{subscribed{g.id, info(added, g)}});
    return spread(added, x.is_refresh, c);
  }
  if (network::is_newer(known->round, x.round) || x.made_at < known->made_at)
    return;
  const bool is_new_round = known->round != x.round;
  if (is_new_round || depth < known->depth) {
    known->other_parent = no_mote;
    known->round = x.round;
    known->depth = depth;
    known->parent = from;
    known->refreshed_at = c.now;
    return spread(*known, x.is_refresh, c);
  }
  if (depth == known->depth && from != known->parent)
    known->other_parent = from;
}

void event_management::on_message(mote_id /*from*/, const smepp::unsubscribe& x, const group& g,
                                  context c) {
  const auto* const known = find(g.id, x.id);
  if (known != nullptr && known->made_at <= x.made_at && known->depth > 0)
    remove(static_cast<std::size_t>(known - subscriptions_.data()), true, c);
}

/// @param is_announced to the group, so that others remove it too
void event_management::remove(std::size_t at, bool is_announced, context c) {
  const auto gone = subscriptions_[at];
  subscriptions_.erase(subscriptions_.begin() + static_cast<std::ptrdiff_t>(at));
  forget([&](const waiting& x) {
    return x.group == gone.group && x.what.id == gone.id && x.token == 0;
  });
  if (gone.depth > 0)
    c.out.push_back(signal{unsubscribed{gone.group, gone.id, gone.name}});
  if (!is_announced)
    return;
  if (removed_.size() >= config_.removed_max)
    removed_.erase(removed_.begin());
  removed_.push_back({gone.group, gone.id, gone.made_at});
  to_send news{broadcast_mote, gone.group, smepp::unsubscribe{gone.id, gone.made_at}};
  news.copies = config_.flood_copies;
  c.out.push_back(news);
}

void event_management::on_left(mote_id peer, group_id group, context c) {
  for (std::size_t i = subscriptions_.size(); i-- > 0;)
    if (subscriptions_[i].group == group && subscriptions_[i].id.subscriber == peer)
      remove(i, false, c);
}

void event_management::on_group_gone(group_id group, context /*c*/) {
  std::erase_if(subscriptions_, [&](const subscription& x) { return x.group == group; });
  forget([&](const waiting& x) { return x.group == group; });
  std::erase_if(removed_, [&](const removed& x) { return x.group == group; });
}

void event_management::introduce(const newcomer& x, context c) const {
  for (const auto& each : subscriptions_) {
    if (each.group != x.group || each.id.subscriber == x.peer)
      continue;
    to_send copy{x.peer, x.group, message_of(each, true), slot::at_once};
    copy.under = x.session;
    c.out.push_back(copy);
  }
}

// ---- time

void event_management::on_time(const group_management& groups, context c) {
  for (std::size_t i = subscriptions_.size(); i-- > 0;) {
    auto& x = subscriptions_[i];
    const auto* const g = groups.find(x.group);
    if (g == nullptr || !g->sync.is_known())
      continue;
    const bool is_dead =
        x.depth > 0 && c.now - x.refreshed_at > config_.refresh * config_.refreshes_missed;
    if (is_dead || x.expires <= g->sync.at(c.now)) {
      remove(i, false, c);
      continue;
    }
    if (x.depth == 0 && c.now - x.refreshed_at >= config_.refresh) {
      ++x.round;
      x.refreshed_at = c.now;
      spread(x, true, c);
    }
  }
  pump(c);
}

std::optional<instant> event_management::deadline(const group_management& groups) const {
  std::optional<instant> first;
  for (const auto& x : subscriptions_) {
    const auto* const g = groups.find(x.group);
    if (g == nullptr || !g->sync.is_known())
      continue;
    const auto patience = config_.refresh * (x.depth == 0 ? 1 : config_.refreshes_missed);
    first = earliest(first, x.refreshed_at + patience + (x.depth == 0 ? 0ns : 1ns));
    if (x.expires != group_time_max)
      first = earliest(first, g->sync.when(x.expires) + 1us);
  }
  for (const auto& x : queue_)
    if (x.token == 0)
      first = earliest(first, x.due);
  return first;
}

std::size_t event_management::footprint() const {
  constexpr std::size_t one = 2 + 3 + event_name_max + 6 + 6 + 4 + 2 + 1 + 2 + 2 + 4 + 4 + 2;
  constexpr std::size_t queued = 2 + 3 + 2 + 2 + 1 + 8 + event_value_max + 6;
  return config_.subscriptions_max * one + config_.events_max * queued + config_.seen_max * 11 +
         config_.removed_max * 11 + pairwise_.footprint();
}

} // namespace rubicon::smepp
