// Scales of drawings, and where their ticks stand.
#pragma once

#include <string>
#include <vector>

#include "core/time.hpp"

namespace rubicon::page {

/// Values from `low` to `high`, drawn from pixel `begin` to `end`.
struct axis {
  double low = 0;
  double high = 1;
  double begin = 0;
  double end = 1;

  [[nodiscard]] double at(double value) const {
    return high > low ? begin + (value - low) / (high - low) * (end - begin) : (begin + end) / 2;
  }
};

struct tick {
  double value = 0;
  std::string label;
};

/// About `count` round numbers from `low` to `high`.
[[nodiscard]] std::vector<tick> ticks(double low, double high, int count);

/// The same of ecology time in seconds, at round times of a clock.
[[nodiscard]] std::vector<tick> time_ticks(duration length, int count);

/// As few digits as distinguish values that are `step` apart.
[[nodiscard]] std::string number(double x, double step);

} // namespace rubicon::page
