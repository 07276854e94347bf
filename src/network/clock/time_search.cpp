#include "network/clock/time_search.hpp"

#include <algorithm>

namespace rubicon::network {

namespace {

using std::chrono::microseconds;

constexpr duration dispute_spread = 30ms; ///< who distrusts its time asks within this

} // namespace

time_search::time_search(time_search_config config, random_stream rng, instant now)
    : config_(config), rng_(rng), lost_(true), lost_from_(now), listen_until_(now),
      pause_(config.pause) {
  const auto longest = std::max(config_.duty.period, config_.start_quiet);
  due_ = now + (config_.is_root ? config_.start_quiet : rng_.between(config_.start_quiet, longest));
  if (!config_.duty.enabled() && !config_.is_root)
    due_ = now + rng_.between(config_.company, 2 * config_.company); // rounds come by themselves
}

duration time_search::pause_max() const {
  return std::max(config_.pause_max, config_.pause_periods * config_.duty.period);
}

void time_search::begin(time_knowledge knowledge, const time_estimate& clock, instant now) {
  lost_ = true;
  lost_from_ = now;
  window_asks_ = 0;
  if (knowledge == time_knowledge::doubted) {
    due_ = now + rng_.between(0s, dispute_spread);
    return;
  }
  due_ = now + rng_.between(0s, config_.stale_spread);
  if (knowledge == time_knowledge::stale && config_.duty.enabled()) {
    window_asks_ = config_.window_asks;
    due_ = in_next_window(clock, *due_);
  }
}

instant time_search::in_next_window(const time_estimate& clock, instant now) {
  const auto period = in_us(config_.duty.period);
  const auto number = period_number(clock.at(now).time_since_epoch(), period) + 1;
  const auto length = config_.duty.length;
  return clock.when(island_time(number * period)) + rng_.between(length / 4, length / 2);
}

time_search::beacon_due time_search::on_time(instant now, time_knowledge knowledge,
                                             const time_estimate& clock) {
  for (auto& x : old_windows_) {
    if (x && *x <= now) {
      x.reset();
      return beacon_due::plain;
    }
  }
  if (announce_due_ && *announce_due_ <= now) {
    announce_due_ = now + ask_gap();
    if (*announce_due_ >= announce_until_)
      announce_due_.reset();
    return beacon_due::plain;
  }
  if (knowledge == time_knowledge::good) {
    lost_ = asks_ = rests_ = false;
    has_started_ = true;
    due_.reset();
    pause_ = config_.pause;
    return beacon_due::none;
  }
  if (!lost_)
    begin(knowledge, clock, now);
  if (knowledge == time_knowledge::doubted && !asks_ && !rests_) { // cannot wait
    window_asks_ = 0;
    due_ = std::min(*due_, now + dispute_spread);
  }
  if (*due_ > now)
    return beacon_due::none;
  return ask(clock, now);
}

time_search::beacon_due time_search::ask(const time_estimate& clock, instant now) {
  if (!config_.duty.enabled()) {
    due_ = now + rng_.between(pause_, 2 * pause_);
    pause_ = std::min(2 * pause_, config_.pause_max);
    return beacon_due::ask;
  }
  if (window_asks_ > 0) {
    --window_asks_;
    listen_until_ = now + config_.probe_listen;
    due_ = in_next_window(clock, now);
    return beacon_due::ask;
  }
  if (rests_ && now < next_search_) {
    listen_until_ = now + config_.probe_listen;
    if (--probe_left_ > 0)
      due_ = now + config_.probe_pause;
    else
      await_probe(now);
    return beacon_due::ask;
  }
  if (!asks_) {
    const bool has_company = received_ && now - *received_ < config_.start_quiet;
    if (!has_started_ && !config_.is_root && has_company && now < lost_from_ + config_.company) {
      due_ = lost_from_ + rng_.between(config_.company, 2 * config_.company);
      return beacon_due::none;
    }
    asks_ = true;
    rests_ = false;
    has_started_ = true;
    search_end_ = now + config_.duty.period + config_.duty.length;
  }
  due_ = now + ask_gap();
  if (*due_ >= search_end_)
    rest(now);
  return beacon_due::ask;
}

/// The last beacon of a search may be answered yet.
void time_search::rest(instant now) {
  asks_ = false;
  rests_ = true;
  listen_until_ = std::max(listen_until_, now + config_.probe_listen);
  next_search_ = now + rng_.between(pause_, 2 * pause_);
  pause_ = std::min(2 * pause_, pause_max());
  await_probe(now);
}

void time_search::await_probe(instant now) {
  probe_left_ = config_.probe_beacons;
  due_ = std::min(next_search_, now + rng_.between(config_.probe_gap / 2, config_.probe_gap));
}

void time_search::on_asked(instant now) {
  if (asks_ && !config_.is_root)
    due_ = std::max(*due_, now + 2 * ask_gap());
}

void time_search::on_news(std::optional<island_clock::duration> leap, const time_estimate& clock,
                          instant now) {
  const bool was_lost_long = lost_ && now - lost_from_ >= config_.long_search;
  if (!config_.duty.enabled() || config_.is_root || (!leap && !was_lost_long))
    return;
  const auto period = in_us(config_.duty.period);
  listen_until_ = std::max(listen_until_, now + 4 * config_.probe_gap + 2 * config_.duty.period);
  if (!leap)
    return;
  const auto before = clock.at(now) - *leap;
  const auto begin = (period_number(before.time_since_epoch(), period) + 1) * period + *leap;
  const auto length = config_.duty.length;
  for (std::size_t i = 0; i < old_windows_.size(); ++i) {
    const auto opens = clock.when(island_time(begin + static_cast<microseconds::rep>(i) * period));
    old_windows_[i] = opens + rng_.between(length / 4, length / 2);
  }
}

void time_search::announce(instant now) {
  if (!config_.duty.enabled())
    return;
  announce_due_ = now;
  announce_until_ = now + config_.duty.period + config_.duty.length;
}

std::optional<instant> time_search::deadline() const {
  auto next = earliest(due_, announce_due_);
  for (const auto& x : old_windows_)
    next = earliest(next, x);
  return next;
}

} // namespace rubicon::network
