#include "network/turns.hpp"

#include <algorithm>

#include "network/clock/tick_plan.hpp"

namespace rubicon::network {

namespace {

using std::chrono::microseconds;

/// The setting whose slots are in use now; nothing: none are, or it leaves no free part.
std::optional<tick_setting> slotted(instant now, const time_estimate& clock) {
  if (clock.slots_used() == 0 || !clock.synchronised())
    return std::nullopt;
  const auto setting = clock.tick(now);
  return setting && tick_plan(setting->period).has_free_part() ? setting : std::nullopt;
}

} // namespace

/// Drawn once for each tick or window.
duration turns::draw(std::int64_t number, duration spread) {
  if (drawn_for_ != number) {
    drawn_for_ = number;
    offset_ = is_sink_ ? 0ns : rng_.between(0s, spread);
  }
  return offset_;
}

instant turns::next_in_window(instant now, const time_estimate& clock) {
  constexpr int open_quarters = 3;
  const auto period = in_us(window_.period);
  const auto time = clock.at(now).time_since_epoch();
  const auto doubt = clock.doubt(now);
  auto number = period_number(time, period);
  const auto into = time - number * period;
  if (into >= doubt && into < in_us(window_.length) * open_quarters / 4)
    return now;
  number += into < doubt ? 0 : 1;
  const auto begin = number * period + doubt + in_us(draw(number, window_.length / 2));
  return std::max(now, clock.when(island_time(begin)));
}

instant turns::next(instant now, const time_estimate& clock) {
  if (window_.enabled())
    return window_.applies(now, clock) ? next_in_window(now, clock) : now;
  const auto setting = slotted(now, clock);
  if (!setting)
    return now;
  const tick_plan plan(setting->period);
  const auto free_from = plan.free_from(clock.slots_used());
  const microseconds period = setting->period;
  const auto since = clock.at(now) - setting->from;
  auto tick = period_number(since, period);
  if (since - tick * period >= in_us(plan.free_until()))
    ++tick;
  const auto spread = std::min(free_from, (plan.free_until() - free_from) / 2);
  const auto begin =
      setting->from + tick * period + in_us(free_from + draw(setting->first + tick, spread));
  return std::max(now, clock.when(begin));
}

duration turns::longest(instant now, const time_estimate& clock) const {
  if (window_.enabled())
    return window_.applies(now, clock) ? window_.period : 0ns;
  const auto setting = slotted(now, clock);
  return setting ? duration(setting->period) : 0ns;
}

} // namespace rubicon::network
