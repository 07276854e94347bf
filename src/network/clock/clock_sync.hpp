// The clock that all motes of an island share: flooding time synchronisation with an estimate of
// each mote's drift, as FTSP does it (CLK-01, CLK-04). The sink is the root.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/address.hpp"
#include "core/island_time.hpp"
#include "core/time.hpp"
#include "network/clock/clock_line.hpp"
#include "network/clock/clock_stamp.hpp"
#include "network/clock/network_offset.hpp"
#include "network/clock/round_schedule.hpp"
#include "network/clock/time_estimate.hpp"

namespace rubicon::network {

struct clock_sync_config : round_config {
  mote_id self;
  bool is_root = false;
  std::uint8_t era = 0; ///< the root's last one: it begins the next

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
  outdated,   ///< its sender does not know what we know: answer it
};

/// How the time flows through an island; what a mote knows of it is its time_estimate.
///
/// The root owns the time. It numbers its rounds, and counts its **eras**: whenever its time cannot
/// go on from what it was (each of its lives, a time beyond what a stamp holds) a new one begins.
/// A mote believes the newest era that it has received of its root, whatever time that shows, and
/// compares no times of two eras, but to find that the time has gone on as it was. It believes it
/// until no round has come for stale_after; then whatever comes is news.
///
/// Within an era a mote takes a point (own time, island time) from the first stamp of each round,
/// and from any other that is less in doubt than it is itself: so the time flows from those who
/// know it better to those who know it less, and never in a circle. While a point is in dispute the
/// mote asks.
///
/// The island's time is set by the root alone: ticks, windows of sleeping radios and schedules of
/// channels depend on it. Stamps contain what the time is elsewhere beside it: how far the time
/// that peers share is ahead (CLK-08).
class clock_sync {
public:
  static constexpr std::chrono::microseconds promised{60}; ///< by the wander alone, at each hop

  clock_sync() = default;
  clock_sync(clock_sync_config config, instant now);

  [[nodiscard]] const time_estimate& time() const { return time_; }

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
  [[nodiscard]] std::optional<instant> deadline() const { return rounds_.deadline(); }

  /// Whether there is no reason to ask: rounds come, nothing is in dispute, answers come.
  [[nodiscard]] bool is_trusted(instant now) const;

  /// No answer comes any more (time_estimate::distrust()).
  void distrust() {
    if (!config_.is_root)
      time_.distrust();
  }
  /// When is_trusted() ends, or has ended, if no round comes.
  [[nodiscard]] std::optional<instant> stale_at() const {
    return config_.is_root || !news_ ? std::nullopt : std::optional(*news_ + config_.stale_after);
  }

  /// Our route to the sink leads to this root now: if it is another than ours, its time is news.
  void follow(mote_id root) {
    if (news_ && root != root_ && root != no_mote)
      news_.reset();
  }

  /// Our own clock has leapt forward by so much, or back: its owner's timers have not.
  void on_clock_leapt(std::chrono::microseconds by) { time_.shift(by); }

  /// The root's.
  [[nodiscard]] std::uint8_t era() const { return era_; }

  /// Between the root's rounds for us to keep to what is promised; nothing: no less than it makes.
  [[nodiscard]] std::optional<duration> wanted_period() const;

  /// A mote needs rounds so often. @pre is_root
  void request_period(duration x, instant now);

  /// Others learn it in rounds that begin at once; it is to begin when all have. @pre is_root,
  /// x.period > 0, x.first is what the setting before shows at x.from
  void set_tick(const tick_setting& x, instant now);

  /// As time_estimate::slots_used(). Others learn it; of a change in a round that begins at once.
  /// @pre is_root, at most 7
  void use_slots(std::uint8_t sevenths, instant now);

  /// A new era begins, in which the time is this one. @pre is_root
  void set_time(island_time x, instant now);

  /// What the time that peers share is now, by a reference that only the root has, and how much
  /// faster than our own clock it goes, as far as is known; all learn it, and of a correction of
  /// more than a millisecond in a round that begins at once. @pre is_root
  void set_network_time(duration since_1970, double rate, instant now);

  [[nodiscard]] static std::size_t footprint() { return clock_line::footprint() + 60; }

private:
  /// A reading of the time that peers share.
  struct network_reading {
    duration since_1970;
    double rate = 0;
    instant own;
  };

  [[nodiscard]] bool is_stale(instant now) const {
    return !news_ || now - *news_ >= config_.stale_after;
  }
  [[nodiscard]] bool is_news(const clock_stamp& x, instant sfd) const;
  [[nodiscard]] stamp_value judge_by_root(const clock_stamp& x, const clock_point& here,
                                          instant sfd);
  [[nodiscard]] stamp_value judge(const clock_stamp& x, const clock_point& here);
  [[nodiscard]] stamp_value judge_news(const clock_stamp& x, const clock_point& here);
  void take_news(const clock_stamp& x, instant sfd);
  void begin_era(island_time x, instant now);
  void resume(instant now);

  clock_sync_config config_;
  time_estimate time_;
  mote_id root_;
  std::uint8_t era_ = 0;
  std::uint16_t sequence_ = 0;
  std::optional<instant> news_; ///< when the last round came
  round_schedule rounds_;
  std::optional<network_reading> reference_; ///< of a root that listens: the last one
  network_offset announced_;                 ///< of a root, in its last round
};

} // namespace rubicon::network
