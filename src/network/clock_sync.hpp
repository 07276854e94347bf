// The clock that all motes of an island share: flooding time synchronisation with an estimate of
// each mote's drift, as FTSP does it (CLK-01, CLK-04, A-11). The sink is the root.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <tuple>
#include <vector>

#include "core/address.hpp"
#include "core/codec.hpp"
#include "core/island_time.hpp"
#include "core/time.hpp"

namespace rubicon::network {

/// How the time that peers share goes on, as seen from an island's.
struct network_line {
  island_clock::duration ahead{}; ///< network time since 1970 minus the island's, at some moment
  double rate = 0;                ///< by how much it goes faster, +-320 ppm

  friend bool operator==(const network_line&, const network_line&) = default;
};

/// What a beacon says about the island's clock: 27 octets, network byte order; 10 more if it tells
/// the network time, as the highest bit of tick.from does then: ahead (8) and rate (2, in
/// hundredths of a ppm).
struct clock_stamp {
  mote_id root;
  std::uint16_t sequence = 0; ///< of the root's broadcast that this derives from; wraps
  island_time time;           ///< when the beacon was handed to the radio; 48 bits of microseconds
  /// From then to its start-of-frame delimiter on the air, microseconds: the radio writes it.
  std::uint32_t age_us = 0;
  tick_setting tick;           ///< its period below 2^13 milliseconds,
  std::uint8_t slots_used = 0; ///< whose three highest bits are this: as clock_sync::slots_used()
  /// How far `time` may be wrong: 2^(x/8) microseconds, rounded up; 0: it is the root's own.
  std::uint8_t doubt = 0;
  /// At `time`; nothing: the root does not know it (CLK-08).
  std::optional<network_line> network = std::nullopt;

  friend bool operator==(const clock_stamp&, const clock_stamp&) = default;
};

inline constexpr std::size_t clock_stamp_size = 27;   ///< without the network time,
inline constexpr std::size_t network_line_size = 10;  ///< which comes last
inline constexpr std::size_t clock_stamp_age_at = 10; ///< where the age lies in it

/// @pre 0 <= x.tick.from < 2^47 microseconds, more than four years
void write(byte_writer& to, const clock_stamp& x);

/// What is missing reads as zeros; from.ok() tells.
[[nodiscard]] clock_stamp read_clock_stamp(byte_reader& from);

/// As in clock_stamp::doubt.
[[nodiscard]] std::uint8_t doubt_of(std::chrono::microseconds x);
[[nodiscard]] std::chrono::microseconds limit_of(std::uint8_t doubt);

struct clock_sync_config {
  mote_id self;
  bool is_root = false;
  duration period = 4min;     ///< between the root's broadcasts when nothing changes;
  duration period_first = 1s; ///< of the first ones, when it has started or something has changed:
  unsigned first_rounds = 4;  ///< after so many each gap is twice as long as the one before
  duration resume_wait = 3s;  ///< a root that starts listens so long for the time it had before
  duration stale_after = 12min; ///< without news of the root: it may have begun anew
  tick_setting tick;            ///< the root's, unless it hears the one it had before
};

/// All times of a mote are `instant`s of its own clock, which runs too fast or too slow by some
/// parts per million; this class tells what the island's clock shows then, and how wrong that may
/// be.
///
/// A mote takes a point (own time, island time) from the first stamp that it hears of each of the
/// root's broadcasts, and from any other that is less in doubt than it is itself: so the time flows
/// from those who know it better to those who know it less, and never in a circle. A straight line
/// through the newest points that lie far enough apart gives offset and rate; before there are such
/// the rate is that of the line before, or none. No crystal's rate is beyond rate_max. A point
/// farther off the line than both doubts explain is ignored, with all that its stamp says; two
/// rounds in succession that agree start a new line.
///
/// The island's time is never set by anybody but the root: ticks, windows of sleeping radios and
/// schedules of channels hang on it. What the time is elsewhere is told beside it: how far the time
/// that peers share is ahead of it (CLK-08). That may leap without a tick skipped.
class clock_sync {
public:
  static constexpr std::size_t points_max = 6;
  static constexpr std::chrono::microseconds outlier{1000}; ///< beyond what the doubts explain
  static constexpr double rate_max = 200e-6; ///< of one crystal against another, +-100 ppm each

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
  /// The first microsecond of our own clock at which at() is `x`, or more. @pre synchronised()
  [[nodiscard]] instant when(island_time x) const;

  /// How far at() may be wrong then: grows while no point comes. @pre synchronised()
  [[nodiscard]] std::chrono::microseconds doubt(instant x) const;
  /// Whether the time is known so well.
  [[nodiscard]] bool knows_within(duration limit, instant x) const {
    return synchronised() && doubt(x) <= limit;
  }

  /// Our route to the sink leads to this root now: if it is another than ours, its time is news.
  void follow(mote_id root) {
    if (heard_ && root != root_ && root != no_mote)
      heard_.reset();
  }

  /// The setting that holds, or the first one known; nothing before a stamp was heard. Where the
  /// time that peers share is known ticks are at multiples of the period in that time, and T is
  /// their number since 1970 (32 bits), here as everywhere (PAR-01, SYN-11): `from` is the last
  /// one.
  [[nodiscard]] std::optional<tick_setting> tick(instant now) const;

  /// Others learn it in rounds that begin at once; it is to begin when all have. @pre is_root,
  /// x.period > 0, x.first is what the setting before shows at x.from
  void set_tick(const tick_setting& x, instant now);

  /// Where in the tick motes of the island send synaptic vectors, as far as is known: 0 nowhere,
  /// else in so many sevenths of the slots (network/tick_plan.hpp).
  [[nodiscard]] std::uint8_t slots_used() const { return slots_used_; }

  /// Others learn it; of a change in a round that begins at once. @pre is_root, at most 7
  void use_slots(std::uint8_t sevenths, instant now);

  /// The root's time is to be this one from now on. @pre is_root
  void set_time(island_time x, instant now);

  /// What the time that peers share is now, by a reference that only the root has, and how much
  /// faster than our own clock it goes, as far as is known; all learn it, and of a correction of
  /// more than a millisecond in a round that begins at once. @pre is_root
  void set_network_time(duration since_1970, double rate, instant now);

  /// The time that peers share, since 1970; nothing: the root has no reference, or has not told it.
  [[nodiscard]] std::optional<duration> network_time(instant x) const;

  /// By how much our clock is too slow, as far as is known: 1e-6 is 1 ppm.
  [[nodiscard]] double drift() const { return slope_; }
  [[nodiscard]] std::uint64_t steps() const { return steps_; } ///< lines begun anew (CLK-05)
  /// Of a mote, which keeps its points as 32 bits of time and difference from the middle.
  [[nodiscard]] static std::size_t footprint() { return 20 + points_max * 8 + 36 + 18; }

private:
  struct point {
    instant own;
    std::int64_t ahead_us = 0; ///< island time minus own time
    std::uint16_t sequence = 0;
  };

  [[nodiscard]] bool is_news(const clock_stamp& x, instant sfd);
  [[nodiscard]] bool is_better(const clock_stamp& x, instant sfd) const;
  bool add_point(const clock_stamp& x, instant sfd);
  void start_rounds(instant now);
  [[nodiscard]] bool is_running_root() const { return config_.is_root && !listening_until_; }
  [[nodiscard]] std::int64_t ahead_us(instant x) const;
  [[nodiscard]] std::optional<network_line> network_at(island_time x) const;
  void learn_wander(const point& x);
  void fit();
  void learn(const tick_setting& x);

  clock_sync_config config_;
  std::vector<point> points_;
  instant middle_;                          ///< of the points
  double middle_ahead_us_ = 0;              ///< of the line, there
  double slope_ = 0;                        ///< of the line: microseconds per microsecond,
  double slope_doubt_ = rate_max;           ///< which may be wrong by so much
  double wander_ = 0;                       ///< by how much the rate has been found to change
  std::chrono::microseconds point_doubt_{}; ///< of the last point
  std::optional<point> doubtful_;           ///< the last point, if it was far off
  mote_id root_;
  std::uint16_t sequence_ = 0;
  std::uint16_t behind_ = 0;     ///< the last number of our root that it cannot have gone on to,
  unsigned behind_count_ = 0;    ///< and so often that has counted on
  std::optional<instant> heard_; ///< the last news
  std::optional<tick_setting> tick_;
  std::optional<tick_setting> next_tick_; ///< tick_ is known too
  std::uint8_t slots_used_ = 0;
  std::optional<network_line> network_; ///< of the time that peers share, as it was
  island_time network_from_;            ///< then
  /// What a root has been told while it listened: since 1970, rate, when by its own clock.
  std::optional<std::tuple<duration, double, instant>> reference_;
  bool has_told_network_ = false; ///< of the root, in a round:
  network_line told_network_;     ///< this
  island_time told_network_from_; ///< then
  std::optional<instant> next_round_;
  std::optional<instant> listening_until_; ///< a root that has just started
  unsigned rounds_ = 0;                    ///< since start_rounds()
  duration gap_{};                         ///< to the next round
  std::uint64_t steps_ = 0;
};

} // namespace rubicon::network
