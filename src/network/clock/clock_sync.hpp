// The clock that all motes of an island share: flooding time synchronisation with an estimate of
// each mote's drift, as FTSP does it (CLK-01, CLK-04, A-11). The sink is the root.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <tuple>

#include "core/address.hpp"
#include "core/island_time.hpp"
#include "core/time.hpp"
#include "network/clock/clock_line.hpp"
#include "network/clock/clock_stamp.hpp"

namespace rubicon::network {

struct clock_sync_config {
  mote_id self;
  bool is_root = false;
  std::uint8_t era = 0; ///< the root's last one: it begins the next

  /// Between the root's broadcasts after its start or a change. After first_rounds each gap is
  /// twice as long as the one before, up to `period` or what a mote has requested, but period_least
  /// at least. A request holds for request_hold.
  duration period_first = 1s;
  static constexpr unsigned first_rounds = 4;
  duration period = 1min;
  duration period_least = 10s;
  static constexpr duration request_hold = 15min;

  /// A root that starts listens so long for the time it had before, or so long after an answer.
  duration resume_wait = 3s;
  static constexpr duration resume_more = 300ms;

  duration stale_after = 3min; ///< without a round of the root: it may have begun anew
  tick_setting tick;           ///< the root's, unless it learns the one it had before
};

/// What a stamp was worth.
enum class stamp_value : std::uint8_t {
  none,
  point,      ///< of the same round, better than what we had
  news,       ///< a round that others should learn of soon
  leap,       ///< news, and the island's time is not what we took it for
  in_dispute, ///< it does not fit what we know: ask others
  outdated,   ///< its sender does not know what we know: tell it
};

/// All times of a mote are `instant`s of its own clock, which runs too fast or too slow by some
/// parts per million; this class tells what the island's clock shows then, and how wrong that may
/// be.
///
/// The root owns the time. It numbers its rounds, and counts its **eras**: whenever its time cannot
/// go on from what it was (each of its lives, a time beyond what a stamp holds) a new one begins.
/// A mote believes the newest era that it has received of its root, whatever time that shows, and
/// compares no times of two eras, but to find that the time has gone on as it was. It believes it
/// until no round has come for stale_after; then whatever comes is news.
///
/// Within an era a mote takes a point (own time, island time) from the first stamp of each round,
/// and from any other that is less in doubt than it is itself: so the time flows from those who
/// know it better to those who know it less, and never in a circle. A point farther off the line
/// than both doubts explain is in dispute: until another stamp agrees with the line, or with the
/// point, the doubt is as large as the difference, and the mote asks. The line is then kept, or
/// begins anew at the point. A mote that has been silent in its neighbours' ears (distrust())
/// believes the first stamp that comes.
///
/// The island's time is never set by anybody but the root: ticks, windows of sleeping radios and
/// schedules of channels depend on it. What the time is elsewhere is told beside it: how far the
/// time that peers share is ahead of it (CLK-08). That may leap without a tick skipped.
class clock_sync {
public:
  static constexpr std::chrono::microseconds outlier{1000}; ///< beyond what the doubts explain
  static constexpr std::chrono::microseconds promised{60};  ///< by the wander alone, at each hop

  clock_sync() = default;
  clock_sync(clock_sync_config config, instant now);

  /// A beacon's stamp. @param sfd when its start-of-frame delimiter was received, by our clock
  stamp_value on_stamp(const clock_stamp& x, instant sfd);

  /// Whether a stamp is of the round that we know of.
  [[nodiscard]] bool is_of_last_round(const clock_stamp& x) const {
    return x.root == root_ && x.era == era_ && x.sequence == sequence_;
  }

  /// What to say in a beacon handed to the radio now; nothing while we do not know the time.
  [[nodiscard]] std::optional<clock_stamp> stamp(instant now) const;

  /// Harmless before deadline(). @returns whether the root has begun a round: a beacon is due now
  bool on_time(instant now);
  [[nodiscard]] std::optional<instant> deadline() const { return next_round_; }

  [[nodiscard]] bool synchronised() const { return is_running_root() || !line_.empty(); }

  /// @pre synchronised()
  [[nodiscard]] island_time at(instant x) const { return line_.at(x); }
  /// The first microsecond of our own clock at which at() is `x`, or more. @pre synchronised()
  [[nodiscard]] instant when(island_time x) const { return line_.when(x); }

  /// How far at() may be wrong then: grows while no point comes. @pre synchronised()
  [[nodiscard]] std::chrono::microseconds doubt(instant x) const;
  /// Whether the time is known so well.
  [[nodiscard]] bool knows_within(duration limit, instant x) const {
    return synchronised() && doubt(x) <= limit;
  }

  /// Whether there is no reason to ask: rounds come, nothing is in dispute, nobody is missed.
  [[nodiscard]] bool is_trusted(instant now) const;

  /// Nobody answers any more: our time may be wrong by any amount. Ends with the next stamp that
  /// shows whether it is.
  void distrust() { distrusted_ = !config_.is_root; }
  [[nodiscard]] bool is_distrusted() const { return distrusted_; }
  /// Or a stamp has shown that it may be.
  [[nodiscard]] bool is_disputed() const { return distrusted_ || disputed_; }
  /// When is_trusted() ends, or has ended, if no round comes.
  [[nodiscard]] std::optional<instant> stale_at() const {
    return config_.is_root || !news_ ? std::nullopt : std::optional(*news_ + config_.stale_after);
  }

  /// By how much the island's time was other than what we took it for, at the last leap.
  [[nodiscard]] std::chrono::microseconds last_leap() const { return last_leap_; }

  /// Our route to the sink leads to this root now: if it is another than ours, its time is news.
  void follow(mote_id root) {
    if (news_ && root != root_ && root != no_mote)
      news_.reset();
  }

  /// Our own clock has leapt forward by so much, or back: its owner's timers have not.
  void on_clock_leapt(std::chrono::microseconds by);

  /// The root's.
  [[nodiscard]] std::uint8_t era() const { return era_; }

  /// Between the root's rounds for us to keep to what is promised; nothing: no less than it makes.
  [[nodiscard]] std::optional<duration> wanted_period() const;

  /// A mote needs rounds so often. @pre is_root
  void request_period(duration x, instant now);

  /// The setting that holds, or the first one known; nothing before a stamp was received. Where the
  /// time that peers share is known ticks are at multiples of the period in that time, and T is
  /// their number since 1970 (32 bits), here as everywhere (PAR-01, SYN-11): `from` is the last
  /// one.
  [[nodiscard]] std::optional<tick_setting> tick(instant now) const;

  /// Others learn it in rounds that begin at once; it is to begin when all have. @pre is_root,
  /// x.period > 0, x.first is what the setting before shows at x.from
  void set_tick(const tick_setting& x, instant now);

  /// Where in the tick motes of the island send synaptic vectors, as far as is known: 0 nowhere,
  /// else in so many sevenths of the slots (network/clock/tick_plan.hpp).
  [[nodiscard]] std::uint8_t slots_used() const { return slots_used_; }

  /// Others learn it; of a change in a round that begins at once. @pre is_root, at most 7
  void use_slots(std::uint8_t sevenths, instant now);

  /// A new era begins, in which the time is this one. @pre is_root
  void set_time(island_time x, instant now);

  /// What the time that peers share is now, by a reference that only the root has, and how much
  /// faster than our own clock it goes, as far as is known; all learn it, and of a correction of
  /// more than a millisecond in a round that begins at once. @pre is_root
  void set_network_time(duration since_1970, double rate, instant now);

  /// The time that peers share, since 1970; nothing: the root has no reference, or has not told it.
  [[nodiscard]] std::optional<duration> network_time(instant x) const;

  /// By how much our clock is too slow, as far as is known: 1e-6 is 1 ppm.
  [[nodiscard]] double drift() const { return line_.rate(); }
  [[nodiscard]] std::uint64_t steps() const { return steps_; } ///< lines begun anew (CLK-05)
  [[nodiscard]] static std::size_t footprint() { return clock_line::footprint() + 60; }

private:
  using microseconds = std::chrono::microseconds;

  struct clock_point {
    instant own;
    std::int64_t ahead_us = 0; ///< island time minus own time
    microseconds doubt{};
  };

  [[nodiscard]] bool is_running_root() const { return config_.is_root && !listening_until_; }
  [[nodiscard]] bool is_stale(instant now) const {
    return !news_ || now - *news_ >= config_.stale_after;
  }
  [[nodiscard]] bool is_news(const clock_stamp& x, instant sfd) const;
  [[nodiscard]] bool fits(const clock_point& x) const;
  [[nodiscard]] stamp_value judge_by_root(const clock_stamp& x, const clock_point& here,
                                          instant sfd);
  [[nodiscard]] stamp_value judge(const clock_stamp& x, const clock_point& here);
  stamp_value take_point(const clock_point& here, bool is_news, bool at_once);
  void take_news(const clock_stamp& x, instant sfd);
  void begin_era(island_time x, instant now);
  void resume(instant now);
  void start_rounds(instant now);
  [[nodiscard]] std::optional<network_line> network_at(island_time x) const;
  void learn(const tick_setting& x);

  clock_sync_config config_;
  clock_line line_;
  std::optional<clock_point> disputed_;
  bool distrusted_ = false;
  microseconds last_leap_{};
  mote_id root_;
  std::uint8_t era_ = 0;
  std::uint16_t sequence_ = 0;
  std::optional<instant> news_; ///< when the last round came
  std::optional<tick_setting> tick_;
  std::optional<tick_setting> next_tick_; ///< tick_ is known too
  std::uint8_t slots_used_ = 0;
  std::optional<network_line> network_; ///< of the time that peers share, as it was
  island_time network_from_;            ///< then
  /// What a root was told while it listened: since 1970, rate, when by its own clock.
  std::optional<std::tuple<duration, double, instant>> reference_;
  bool has_told_network_ = false; ///< of the root, in a round:
  network_line told_network_;     ///< this
  island_time told_network_from_; ///< then
  std::optional<instant> next_round_;
  std::optional<instant> listening_until_; ///< a root that has just started
  unsigned rounds_ = 0;                    ///< since start_rounds()
  duration gap_{};                         ///< to the next round
  std::optional<duration> requested_;      ///< of the root,
  instant requested_until_;
  instant disputed_at_; ///< when the root last found that a mote's time is another
  std::uint64_t steps_ = 0;
};

} // namespace rubicon::network
