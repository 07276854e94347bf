// Dice: one seeded stream per actor, the same on every machine (design.md section 5).
#pragma once

#include <array>
#include <cassert>
#include <cstdint>
#include <string_view>

#include "core/time.hpp"

namespace rubicon {

/// A stream of random numbers (xoshiro256**, Blackman and Vigna 2018), a regular value.
class random_stream {
public:
  explicit random_stream(std::uint64_t seed = 0);

  /// The stream of one actor: depends on the ecology's seed and the actor's path alone, so adding a
  /// mote does not shift another's random numbers.
  random_stream(std::uint64_t ecology_seed, std::string_view path);

  [[nodiscard]] std::uint64_t next();

  /// Uniform in 0..bound-1, unbiased. @pre bound > 0
  [[nodiscard]] std::uint64_t below(std::uint64_t bound);

  /// Uniform in [0, 1), 53 bits.
  [[nodiscard]] double unit();

  /// True with probability p; draws nothing when p <= 0 or p >= 1.
  [[nodiscard]] bool chance(double p);

  /// Uniform in [from, to). @pre from <= to; equal bounds give `from` without drawing
  [[nodiscard]] duration between(duration from, duration to);

  /// Standard normal deviate.
  [[nodiscard]] double normal();

private:
  std::array<std::uint64_t, 4> state_;
};

} // namespace rubicon
