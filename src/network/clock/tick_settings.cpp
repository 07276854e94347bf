#include "network/clock/tick_settings.hpp"

#include <cassert>

namespace rubicon::network {

namespace {

/// Its first tick is the first one after zero.
tick_setting moved(tick_setting x, std::chrono::microseconds by) {
  const auto from = x.from.time_since_epoch() + by;
  const auto ticks = period_number(from, x.period);
  x.from = island_time(from - ticks * std::chrono::microseconds(x.period));
  x.first = ticks > x.first ? 0 : static_cast<std::uint32_t>(x.first - ticks);
  return x;
}

} // namespace

void tick_settings::learn(const tick_setting& x) {
  if (!current_) {
    current_ = x;
  } else if (x == *current_) {
    next_.reset();
  } else if (x != next_) {
    if (next_)
      current_ = next_;
    next_ = x;
  }
}

void tick_settings::replace(const tick_setting& x) {
  current_ = x;
  next_.reset();
}

void tick_settings::move(std::chrono::microseconds by) {
  assert(known());
  current_ = moved(*current_, by);
  if (next_)
    next_ = moved(*next_, by);
}

std::optional<tick_setting> tick_settings::at(std::optional<island_time> time) const {
  return next_ && time && *time >= next_->from ? next_ : current_;
}

tick_setting tick_settings::newest() const {
  return next_ ? *next_ : current_.value_or(tick_setting{});
}

} // namespace rubicon::network
