// How one clock is ahead of another: a straight line through the newest points at which both were
// read, and how far it may be wrong (CLK-01).
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/island_time.hpp"
#include "core/time.hpp"

namespace rubicon::network {

/// A clock's reading, rounded down.
[[nodiscard]] inline std::int64_t us_of(instant x) {
  return std::chrono::floor<std::chrono::microseconds>(x.time_since_epoch()).count();
}

/// Least squares over the newest points, each weighted by its noise, gives offset and rate; before
/// points are far enough apart the rate is the one known before, or none. A point with less than
/// half the noise of those just before it takes their place. A crystal's rate wanders, as its
/// temperature does: how fast is measured by how far the line misses each new point, and decides
/// how old a point may be to be used, and for how long the line keeps a promised bound.
class clock_line {
public:
  using microseconds = std::chrono::microseconds;

  static constexpr std::size_t points_max = 6;
  static constexpr double rate_max = 200e-6; ///< of one crystal against another, +-100 ppm each

  [[nodiscard]] bool empty() const { return points_.empty(); }

  /// Both clocks read at the same moment, wrong by `noise` at most.
  void add(instant own, std::int64_t ahead_us, microseconds noise);

  /// Begins anew at such a point. The rate of the two crystals against each other is kept, and
  /// doubted as much as it would explain by how much the line has missed the point.
  void restart(instant own, std::int64_t ahead_us, microseconds noise);

  /// A line without points through this one, whose rate is 0.
  void set(instant own, std::int64_t ahead_us);

  /// One of the clocks has leapt: the other is so much more ahead at each point.
  void shift(microseconds by);

  /// All is forgotten, as of another crystal.
  void clear() { *this = {}; }

  /// Microseconds by which the other clock is ahead then.
  [[nodiscard]] std::int64_t ahead_us(instant x) const;
  [[nodiscard]] island_time at(instant x) const;
  /// The first microsecond of our own clock at which at() is `x`, or more.
  [[nodiscard]] instant when(island_time x) const;

  /// How far at() may be wrong then. @pre !empty()
  [[nodiscard]] microseconds doubt(instant x) const;

  /// So long after a point the wander that was seen makes the line wrong by `limit`.
  [[nodiscard]] duration lasts(microseconds limit) const;

  /// By how much our own clock is too slow: 1e-6 is 1 ppm.
  [[nodiscard]] double rate() const { return slope_; }

  /// On a mote, which keeps its points as 32 bits of time and difference from the middle, and 16
  /// of noise.
  [[nodiscard]] static std::size_t footprint() { return points_max * 10 + 32; }

private:
  struct point {
    instant own;
    std::int64_t ahead_us = 0;
    microseconds noise{};
  };

  void learn_wander(const point& x, microseconds noise);
  void fit();
  void fit_middle(std::span<const point> used, double least);
  void fit_slope(std::span<const point> used, double least);
  [[nodiscard]] double missed(const point& x) const; ///< by the line, in microseconds
  [[nodiscard]] double wander() const;
  [[nodiscard]] duration span_wanted() const;
  [[nodiscard]] double missed_by_wander(double since) const;

  std::vector<point> points_;
  instant middle_;             ///< of the points that are used
  double middle_ahead_us_ = 0; ///< of the line, there
  double slope_ = 0;
  double slope_doubt_ = rate_max; ///< of noise alone
  double wander_seen_ = 0;        ///< by how much the rate changes, 1/s
  double wander_assumed_ = 3e-7;  ///< until points show that it is less: +-20 ppm in 10 min, twice
  double lag_ = 0;                ///< age of the rate when the newest point came, s
  microseconds noise_{};          ///< of the newest point and of the line there
};

} // namespace rubicon::network
