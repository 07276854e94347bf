// Dice: one seeded stream per actor, the same on every machine (docs/architecture.md, Time).
#pragma once

#include <array>
#include <cassert>
#include <cstdint>
#include <optional>
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

  /// While a reseeding lives, mixed with its key.
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

  /// The deviate that belongs to a seed, whatever reseeding there is.
  [[nodiscard]] static double fixed_normal(std::uint64_t seed);

private:
  [[nodiscard]] std::uint64_t draw();

  std::array<std::uint64_t, 4> state_;
};

/// Another future of a run: while it lives, all streams of the process, those there are and those
/// to come, give other numbers than their seeds say (docs/architecture.md, Time). One at a time,
/// begun and ended while no other thread draws.
class reseeding {
public:
  /// What is drawn anew.
  struct settings {
    instant since;
    std::uint64_t key = 0; ///< equal keys give equal futures

    friend bool operator==(const settings&, const settings&) = default;
  };

  explicit reseeding(const settings& x);
  ~reseeding();
  reseeding(const reseeding&) = delete;
  reseeding& operator=(const reseeding&) = delete;

  /// Of the one that lives, for what is computed from a seed at any time.
  [[nodiscard]] static std::optional<settings> current();
};

} // namespace rubicon
