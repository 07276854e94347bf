// The clock that all motes of an island share: flooding time synchronisation with an estimate of
// each mote's drift, as FTSP does it (CLK-01, CLK-04, A-11). The sink is the root.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/address.hpp"
#include "core/codec.hpp"
#include "core/island_time.hpp"
#include "core/time.hpp"

namespace rubicon::network {

/// What a beacon says about the island's clock: 26 octets, network byte order; 8 more if it tells
/// the network time, as the highest bit of tick.from does then.
struct clock_stamp {
  mote_id root;
  std::uint16_t sequence = 0; ///< of the root's broadcast that this derives from; wraps
  island_time time;           ///< when the beacon was handed to the radio; 48 bits of microseconds
  /// From then to its start-of-frame delimiter on the air, microseconds: the radio writes it.
  std::uint32_t age_us = 0;
  tick_setting tick;           ///< its period below 2^13 milliseconds,
  std::uint8_t slots_used = 0; ///< whose three highest bits are this: as clock_sync::slots_used()
  /// Network time minus the island's; nothing: the root does not know it (CLK-08).
  std::optional<island_clock::duration> network_ahead = std::nullopt;

  friend bool operator==(const clock_stamp&, const clock_stamp&) = default;
};

inline constexpr std::size_t clock_stamp_size = 26;   ///< without the network time,
inline constexpr std::size_t network_ahead_size = 8;  ///< which comes last
inline constexpr std::size_t clock_stamp_age_at = 10; ///< where the age lies in it

/// @pre 0 <= x.tick.from < 2^47 microseconds, more than four years
void write(byte_writer& to, const clock_stamp& x);

/// What is missing reads as zeros; from.ok() tells.
[[nodiscard]] clock_stamp read_clock_stamp(byte_reader& from);

struct clock_sync_config {
  mote_id self;
  bool is_root = false;
  duration period = 10s; ///< of the root's broadcasts (A-11)
  duration period_first =
      1s; ///< of its first ones, so that those who have just come know drift soon
  unsigned first_rounds = 4;
  duration resume_wait = 3s; ///< a root that starts listens so long for the time it had before
  tick_setting tick;         ///< the root's, unless it hears the one it had before
};

/// All times of a mote are `instant`s of its own clock, which runs too fast or too slow by some
/// parts per million; this class tells what the island's clock shows then.
///
/// A mote takes one point (own time, island time) from the first stamp that it hears of each of the
/// root's broadcasts; a straight line through the last of them gives offset and drift. A point far
/// off the line is ignored, two in succession that agree start a new line.
///
/// The island's time is never set by anybody but the root: ticks, windows of sleeping radios and
/// schedules of channels hang on it. What the time is elsewhere is told beside it: how far the time
/// that peers share is ahead of it (CLK-08). That may leap without a tick skipped.
class clock_sync {
public:
  static constexpr std::size_t points_max = 8;
  static constexpr std::chrono::microseconds outlier{1000};

  clock_sync() = default;
  clock_sync(clock_sync_config config, instant now);

  /// A beacon's stamp. @param sfd when its start-of-frame delimiter was received, by our clock
  /// @returns whether it was news, so that our own next beacon should not wait for long
  bool on_stamp(const clock_stamp& x, instant sfd);

  /// Whether a stamp is of the round that we heard of last.
  [[nodiscard]] bool is_of_last_round(const clock_stamp& x) const {
    return x.root == root_ && x.sequence == sequence_;
  }

  /// What to say in a beacon handed to the radio now; nothing while we do not know the time.
  [[nodiscard]] std::optional<clock_stamp> stamp(instant now) const;

  /// Harmless before deadline(). @returns whether the root has begun a round: a beacon is due now
  bool on_time(instant now);
  [[nodiscard]] std::optional<instant> deadline() const { return next_round_; }

  [[nodiscard]] bool synchronised() const { return is_running_root() || !points_.empty(); }

  /// @pre synchronised()
  [[nodiscard]] island_time at(instant x) const;
  [[nodiscard]] instant when(island_time x) const;

  /// The setting that holds, or the first one known; nothing before a stamp was heard.
  [[nodiscard]] std::optional<tick_setting> tick(instant now) const;

  /// Others learn it; it is to begin when all have. @pre is_root, x.period > 0, x.first is what the
  /// setting before shows at x.from
  void set_tick(const tick_setting& x) { learn(x); }

  /// Where in the tick motes of the island send synaptic vectors, as far as is known: 0 nowhere,
  /// else in so many sevenths of the slots (network/tick_plan.hpp).
  [[nodiscard]] std::uint8_t slots_used() const { return slots_used_; }

  /// Others learn it; of a change in a round that begins at once. @pre is_root, at most 7
  void use_slots(std::uint8_t sevenths, instant now);

  /// The root's time is to be this one from now on. @pre is_root
  void set_time(island_time x, instant now);

  /// What the time that peers share is now, by a reference that only the root has; all learn it,
  /// and of a correction of more than a millisecond in a round that begins at once. @pre is_root
  void set_network_time(duration since_1970, instant now);

  /// The time that peers share, since 1970; nothing: the root has no reference, or has not told it.
  [[nodiscard]] std::optional<duration> network_time(instant x) const;

  /// By how much our clock is too slow, as far as is known: 1e-6 is 1 ppm.
  [[nodiscard]] double drift() const { return slope_; }
  [[nodiscard]] std::uint64_t steps() const { return steps_; } ///< lines begun anew (CLK-05)
  /// Of a mote, which keeps its points as 32 bits of time and difference from the middle.
  [[nodiscard]] static std::size_t footprint() { return 20 + points_max * 8 + 24 + 8; }

private:
  struct point {
    instant own;
    std::int64_t ahead_us = 0; ///< island time minus own time
  };

  [[nodiscard]] bool is_news(const clock_stamp& x, instant sfd) const;
  [[nodiscard]] bool is_running_root() const { return config_.is_root && !listening_until_; }
  [[nodiscard]] std::int64_t ahead_us(instant x) const;
  [[nodiscard]] std::optional<island_clock::duration> network_ahead(instant x) const;
  void fit();
  void learn(const tick_setting& x);

  clock_sync_config config_;
  std::vector<point> points_;
  instant middle_;                ///< of the points
  double middle_ahead_us_ = 0;    ///< of the line, there
  double slope_ = 0;              ///< of the line: microseconds per microsecond
  std::optional<point> doubtful_; ///< the last point, if it was far off
  mote_id root_;
  std::uint16_t sequence_ = 0;
  std::optional<instant> heard_; ///< the last news
  std::optional<tick_setting> tick_;
  std::optional<tick_setting> next_tick_; ///< tick_ is known too
  std::uint8_t slots_used_ = 0;
  std::optional<island_clock::duration> network_ahead_;     ///< of the island's time, as heard
  std::optional<island_clock::duration> network_ahead_own_; ///< of our own, a root's with reference
  std::optional<instant> next_round_;
  std::optional<instant> listening_until_; ///< a root that has just started
  unsigned rounds_ = 0;
  std::uint64_t steps_ = 0;
};

} // namespace rubicon::network
