// A random walk that can be asked for any time.
#pragma once

#include <cstdint>

#include "core/time.hpp"

namespace rubicon::device {

/// The longest time a walk goes on; it stands still afterwards.
inline constexpr duration random_walk_end{std::int64_t{1} << 59U}; // 18 years

/// Standard Brownian motion: 0 at time 0, and its changes over an interval of t seconds have the
/// variance t. A function of seed and time alone, whatever was asked for before; of a reseeding
/// too, from its time on. Straight within steps of about a millisecond.
[[nodiscard]] double brownian(std::uint64_t seed, duration time);

/// `x` thrown back at both bounds as often as it takes. @pre min < max
[[nodiscard]] double reflected(double x, double min, double max);

} // namespace rubicon::device
