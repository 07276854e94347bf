// The time types every room uses. Time is an argument: the clock below has no now().
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

namespace rubicon {

/// A length of ecology time, in nanoseconds.
using duration = std::chrono::nanoseconds;

/// The clock of an ecology. It has no now(): a core that tries to read it does not compile.
struct ecology_clock {
  using duration = rubicon::duration;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<ecology_clock>;
  static constexpr bool is_steady = true;
};

/// A point of ecology time; instant{} is the start of the run.
using instant = ecology_clock::time_point;

using std::chrono_literals::operator""h;
using std::chrono_literals::operator""min;
using std::chrono_literals::operator""s;
using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""us;
using std::chrono_literals::operator""ns;

/// The earlier of two deadlines, where nothing means "never".
[[nodiscard]] inline std::optional<instant> earliest(std::optional<instant> a,
                                                     std::optional<instant> b) {
  if (!a)
    return b;
  return b ? std::min(*a, *b) : a;
}

/// @returns `x` in seconds, exact to the double's precision
[[nodiscard]] constexpr double seconds(duration x) {
  return std::chrono::duration<double>(x).count();
}

/// @returns seconds with six decimals, as the logs show ecology time: `12.004160`
[[nodiscard]] std::string to_text(instant x);

/// @returns a length of time for people, in the largest fitting unit: `31 s`, `10 min`, `1.5 ms`
[[nodiscard]] std::string to_text(duration x);

} // namespace rubicon
