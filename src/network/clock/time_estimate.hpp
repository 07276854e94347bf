// What a mote knows of the time of its island, and of the time that peers share (CLK-01, CLK-05,
// CLK-08).
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "core/island_time.hpp"
#include "core/time.hpp"
#include "network/clock/clock_line.hpp"
#include "network/clock/network_offset.hpp"
#include "network/clock/tick_settings.hpp"

namespace rubicon::network {

/// A reading of the island's clock, as a stamp has brought it.
struct clock_point {
  instant own;
  std::int64_t ahead_us = 0; ///< island time minus own time
  std::chrono::microseconds doubt{};
};

/// What is known of a point before it is compared with the line.
struct point_origin {
  bool is_news = false;     ///< of a round that was not known
  bool is_believed = false; ///< even if the line is far off
  bool has_leapt = false;   ///< then the root's time has leapt, not its rate
};

/// What has become of a point.
enum class point_fate : std::uint8_t {
  taken,
  disputed, ///< kept until another decides
  restarted ///< the line began anew at it
};

/// All times of a mote are `instant`s of its own clock, which runs too fast or too slow by some
/// parts per million; this class says what the island's clock shows then, and how wrong that may
/// be.
///
/// A point farther off the line than both doubts explain is in dispute: until another point agrees
/// with the line, or with that one, the doubt is as large as the difference. The line is then kept,
/// or begins anew at the point. A mote that gets no answers from its neighbours (distrust())
/// believes the first point that comes. The time of a root is its own, and right by definition.
///
/// What the time is elsewhere stands beside it: how far the time that peers share is ahead of the
/// island's. That may leap without a tick skipped.
class time_estimate {
public:
  using microseconds = std::chrono::microseconds;

  static constexpr microseconds outlier{1000}; ///< beyond what the doubts explain

  [[nodiscard]] bool synchronised() const { return is_own_ || !line_.empty(); }
  /// Whether the time is this mote's own: it is a root that does not listen any more.
  [[nodiscard]] bool is_own() const { return is_own_; }

  /// @pre synchronised()
  [[nodiscard]] island_time at(instant x) const { return line_.at(x); }
  /// The first microsecond of our own clock at which at() is `x`, or more. @pre synchronised()
  [[nodiscard]] instant when(island_time x) const { return line_.when(x); }

  /// How far at() may be wrong then: grows while no point comes. @pre synchronised()
  [[nodiscard]] microseconds doubt(instant x) const;
  [[nodiscard]] bool is_distrusted() const { return distrusted_; }
  /// Or a point has shown that the time may be wrong.
  [[nodiscard]] bool is_disputed() const { return distrusted_ || disputed_; }

  /// Through the points that were taken, without the one in dispute.
  [[nodiscard]] const clock_line& line() const { return line_; }
  [[nodiscard]] std::uint64_t steps() const { return steps_; } ///< lines begun anew (CLK-05)
  /// By how much the island's time was other than what we took it for, at the last step.
  [[nodiscard]] microseconds last_leap() const { return last_leap_; }

  /// The setting that holds, or the first one known; nothing before a stamp was received. Where the
  /// time that peers share is known ticks are at multiples of the period in that time, and T is
  /// their number since 1970 (32 bits), here as everywhere (PAR-01, SYN-11): `from` is the last
  /// one.
  [[nodiscard]] std::optional<tick_setting> tick(instant now) const;

  /// The time that peers share, since 1970; nothing: it is not known.
  [[nodiscard]] std::optional<duration> network_time(instant x) const;

  /// Where in the tick motes of the island send synaptic vectors, as far as is known: 0 nowhere,
  /// else in so many sevenths of the slots (network/clock/tick_plan.hpp).
  [[nodiscard]] std::uint8_t slots_used() const { return slots_used_; }

  // What changes it.

  /// Whether the point is as near to the line as both doubts explain. @pre synchronised()
  [[nodiscard]] bool fits(const clock_point& x) const;
  point_fate take(const clock_point& x, point_origin origin);
  /// No answer comes any more: our time may be wrong by any amount. Ends with the next point that
  /// shows whether it is.
  void distrust() { distrusted_ = true; }
  /// From now on the time is our own, and this one.
  void set(island_time x, instant now);
  /// Our own clock has leapt forward by so much, or back.
  void shift(microseconds by);
  /// Another time follows, by a crystal that we know nothing of.
  void forget();

  void use_slots(std::uint8_t sevenths) { slots_used_ = sevenths; }
  void set_network(network_offset x) { network_ = x; }
  [[nodiscard]] const network_offset& network() const { return network_; }
  [[nodiscard]] tick_settings& ticks() { return ticks_; }
  [[nodiscard]] const tick_settings& ticks() const { return ticks_; }

private:
  [[nodiscard]] bool is_confirmed_by(const clock_point& x) const;

  clock_line line_;
  bool is_own_ = false;
  std::optional<clock_point> disputed_;
  bool distrusted_ = false;
  microseconds last_leap_{};
  std::uint64_t steps_ = 0;
  tick_settings ticks_;
  network_offset network_;
  std::uint8_t slots_used_ = 0;
};

} // namespace rubicon::network
