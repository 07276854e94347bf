#include "synaptic/rubicon_clock.hpp"

#include <algorithm>

#include "core/serial_number.hpp"

namespace rubicon::synaptic {

using std::chrono::microseconds;

std::optional<rubicon_clock::tick> rubicon_clock::update(instant now, island_time shared,
                                                         const tick_setting& setting) {
  const microseconds period = setting.period;
  const auto since = shared - setting.from;
  auto first = std::int64_t{setting.first};
  if (last_) { // T has 32 bits, and begins anew: our numbers go on
    const auto number = first + period_number(since, period);
    first += unwrapped(static_cast<std::uint32_t>(number), *last_) - number;
  }
  const auto time_until = [&](std::int64_t number) { return (number - first) * period - since; };
  if (!due_) {
    const auto before = std::max(first + period_number(since - microseconds{1}, period), first - 1);
    last_ = last_ == before + 1 ? last_ : before; // a tick is not reported twice
  }
  auto next = *last_ + 1;
  const auto wait = time_until(next);
  const bool leaps = next != first && (wait < -period / 2 || wait > period + period / 2);
  if (!leaps && wait > microseconds{0}) {
    due_ = now + wait;
    return std::nullopt;
  }
  if (leaps) {
    ++leaps_;
    next = std::max(first + period_number(since, period), first);
  }
  last_ = next;
  due_ = now + std::max<duration>(time_until(next + 1), 0s);
  return tick{static_cast<std::uint32_t>(next), leaps};
}

} // namespace rubicon::synaptic
