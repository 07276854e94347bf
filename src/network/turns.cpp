#include "network/turns.hpp"

#include <algorithm>

#include "network/tick_plan.hpp"

namespace rubicon::network {

namespace {

using std::chrono::microseconds;

microseconds in_us(duration x) {
  return std::chrono::duration_cast<microseconds>(x);
}

/// The setting whose slots are in use now; nothing: none are, or it leaves no free part.
std::optional<tick_setting> slotted(instant now, const clock_sync& clock) {
  if (clock.slots_used() == 0 || !clock.synchronised())
    return std::nullopt;
  const auto setting = clock.tick(now);
  return setting && tick_plan(setting->period).has_free_part() ? setting : std::nullopt;
}

} // namespace

instant turns::next(instant now, const clock_sync& clock) {
  const auto setting = slotted(now, clock);
  if (!setting)
    return now;
  const tick_plan plan(setting->period);
  const auto free_from = plan.free_from(clock.slots_used());
  const microseconds period = setting->period;
  const auto since = clock.at(now) - setting->from;
  auto tick = since / period - (since % period < 0us ? 1 : 0);
  if (since - tick * period >= in_us(plan.free_until()))
    ++tick;
  if (drawn_for_ != tick) {
    drawn_for_ = tick;
    const auto spread = std::min(free_from, (plan.free_until() - free_from) / 2);
    offset_ = is_sink_ ? 0ns : dice_.between(0s, spread);
  }
  const auto begin = setting->from + tick * period + in_us(free_from + offset_);
  return std::max(now, clock.when(begin));
}

duration turns::longest(instant now, const clock_sync& clock) {
  const auto setting = slotted(now, clock);
  return setting ? duration(setting->period) : 0ns;
}

} // namespace rubicon::network
