#include "network/tree/trickle.hpp"

#include <algorithm>
#include <cassert>

namespace rubicon::network {

trickle::trickle(trickle_config config, random_stream rng, instant now)
    : config_(config), rng_(rng) {
  assert(config.interval_min > 0ns && config.interval_min <= config.interval_max);
  begin(config_.interval_min, now);
}

void trickle::begin(duration interval, instant at) {
  interval_ = interval;
  start_ = at;
  due_ = at + rng_.between(interval / 2, interval);
  heard_ = 0;
}

bool trickle::on_time(instant now) {
  if (now < due_)
    return false;
  // An owner that comes late is not made to fire for all it has missed.
  const auto end = std::max(start_ + interval_, now);
  const bool fires = interval_ == config_.interval_max || heard_ < config_.redundancy;
  const bool again = interval_ == config_.interval_min && ++shortest_ < config_.shortest;
  begin(again ? interval_ : std::min(2 * interval_, config_.interval_max), end);
  return fires;
}

instant trickle::certain() const {
  if (interval_ == config_.interval_max)
    return due_;
  auto end = start_ + interval_;
  if (interval_ == config_.interval_min)
    end += (config_.shortest - std::min(config_.shortest, shortest_ + 1)) * interval_;
  for (auto interval = interval_; interval < config_.interval_max; end += interval)
    interval = std::min(2 * interval, config_.interval_max);
  return end;
}

void trickle::shorten(instant now, duration interval) {
  if (interval == config_.interval_min)
    shortest_ = 0;
  if (interval_ > interval)
    begin(interval, now);
}

} // namespace rubicon::network
