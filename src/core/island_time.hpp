// The time that the motes of an island share, and when the RUBICON clock ticks (D1.1 4.2.2).
#pragma once

#include <chrono>
#include <cstdint>

#include "core/time.hpp"

namespace rubicon {

/// The time of an island: what its root's clock says. Its zero is the root's choice.
struct island_clock {
  using duration = std::chrono::microseconds;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<island_clock>;
  static constexpr bool is_steady = true;
};
using island_time = island_clock::time_point;

/// Rounded towards zero.
[[nodiscard]] constexpr island_clock::duration in_us(duration x) {
  return std::chrono::duration_cast<island_clock::duration>(x);
}

/// The number of the period that a time lies in: 0 from zero on, -1 just before it.
[[nodiscard]] constexpr std::int64_t period_number(island_clock::duration since,
                                                   island_clock::duration period) {
  return since / period - (since % period < island_clock::duration{} ? 1 : 0);
}

/// When the RUBICON clock ticks: it shows T = `first` at `from`, and one more each `period`
/// (CLK-03). `from` may lie ahead: until then the setting before it holds.
struct tick_setting {
  std::uint32_t first = 0;
  island_time from;
  std::chrono::milliseconds period{500};

  friend bool operator==(const tick_setting&, const tick_setting&) = default;
};

} // namespace rubicon
