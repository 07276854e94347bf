// How the members of a group come to share a time, well enough for their radios to meet (SMP-26).
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/address.hpp"
#include "core/numbers/random.hpp"
#include "core/time.hpp"
#include "smepp/groups/group_time.hpp"
#include "smepp/messages.hpp"

namespace rubicon::smepp {

struct weak_sync_config {
  mote_id self;
  duration period = 30s;         ///< between a member's stamps, +-10 %
  duration hurry_pause = 1s;     ///< between the first ones, and when somebody new needs them
  duration help_pause = 10s;     ///< until we hurry again for those who have no time
  unsigned hurry_stamps = 3;     ///< so many
  duration root_timeout = 10min; ///< without a newer round: the root is gone
  unsigned periods_missed = 8;   ///< without news: we may be out of step
  duration alone_timeout = 1min; ///< without any stamp, when we know no time: we begin
  /// A correction beyond this is a jump: our windows and our neighbours' may not overlap any more.
  duration jump = 10ms;
  duration span_min = 800ms; ///< between two points that give a rate
};

/// Each member periodically sends the time to all its neighbours. The time is that of one of
/// them, the root: its stamps are numbered in rounds, and the others take from a neighbour what is
/// of a newer round than what they have. A root that has been silent for long is replaced by who
/// first notices; of two roots that meet, the lower one stays. Parts of a group that are cut off
/// so keep the time, each by a root of its own.
///
/// A stamp says when the one before it was on the air (two steps), so no octet is filled in while
/// it is sent, and its error is that of two time stamps of one frame. A straight line through the
/// newest points gives offset and rate. Who has no rate yet gives the time to no other, so a line
/// of members synchronises from the root outwards.
///
/// All `instant`s are of the member's own clock, within 125 ppm of the true one.
class weak_sync {
public:
  static constexpr std::size_t points_max = 6;
  static constexpr std::size_t receptions_max = 12; ///< neighbours; the oldest is replaced
  static constexpr double rate_max = 250e-6;        ///< of one crystal against another

  enum class news : std::uint8_t { none, better, jumped };

  weak_sync() = default;
  weak_sync(weak_sync_config config, random_stream rng, instant now);

  /// We create the group: its time begins with 0, and is ours.
  void begin(instant now);

  /// Takes the approximate time that a member has sent; it is ours until a better one is received.
  void adopt(group_time x, instant now);

  [[nodiscard]] bool is_known() const { return !points_.empty(); }
  /// Offset and rate are known by time stamps of frames, or the time is our own.
  [[nodiscard]] bool is_fine() const { return is_known() && has_rate_; }
  /// No news for so long that our windows and others' may have come apart: to be listened for.
  [[nodiscard]] bool is_lost(instant now) const {
    if (now < chasing_until_)
      return true;
    const auto silent = now - (is_root() ? followed_at_ : newest_);
    const auto limit = config_.periods_missed * config_.period;
    // A root that no mote follows any more may be so for long.
    return is_known() && silent > limit && (!is_root() || (silent - limit) % (8 * limit) < limit);
  }
  [[nodiscard]] bool is_root() const { return is_known() && root_ == config_.self; }
  [[nodiscard]] mote_id root() const { return root_; }
  [[nodiscard]] std::uint16_t round() const { return round_; }

  /// @pre is_known()
  [[nodiscard]] group_time at(instant x) const;
  /// @pre is_known()
  [[nodiscard]] instant when(group_time x) const;
  /// How much faster than ours the group's time goes: 1e-6 is 1 ppm.
  [[nodiscard]] double rate() const { return rate_; }

  /// Fills in the time's part of a stamp that is handed to the radio now. @pre is_known()
  void stamp(sync_stamp& x, instant now);
  /// When the last stamp was on the air, by its start-of-frame delimiter.
  void on_stamp_sent(instant at);

  /// @param at when its start-of-frame delimiter was received
  news on_stamp(mote_id from, const sync_stamp& x, instant at);

  /// A member has a different time: receives for a while to learn it.
  void chase(instant now) { chasing_until_ = now + 5 * config_.period / 2; }

  /// Somebody needs the time soon.
  void hurry(instant now);

  /// Harmless before deadline(). @returns whether a stamp is due, or nothing is known and we go on
  /// by ourselves
  [[nodiscard]] bool on_time(instant now);
  [[nodiscard]] instant deadline() const { return due_; }

  [[nodiscard]] static std::size_t footprint() {
    return points_max * 10 + receptions_max * (2 + 2 + 4) + 20;
  }

private:
  struct point {
    instant own;
    group_time shared;
  };
  struct reception {
    mote_id from;
    std::uint16_t sequence = 0;
    instant at;
  };

  [[nodiscard]] bool is_wanted(const sync_stamp& x) const;
  [[nodiscard]] std::optional<instant> reception_of(mote_id from, std::uint16_t sequence) const;
  void note(mote_id from, std::uint16_t sequence, instant at);
  news take(const point& x, bool is_same_root);

  weak_sync_config config_;
  random_stream rng_;
  std::vector<point> points_; ///< oldest first; of the present line
  double rate_ = 0;
  bool is_timed_ = false; ///< the points are by time stamps of frames
  bool has_rate_ = false; ///< two points have given a rate, now or before
  mote_id root_ = no_mote;
  std::uint16_t round_ = 0;
  std::uint8_t hops_ = 0;
  instant newest_;      ///< when a newer round was received,
  instant followed_at_; ///< and when another of our root was
  instant helped_at_;
  instant chasing_until_;        ///< a better root was received, of whose stamps we need two
  mote_id gone_root_ = no_mote;  ///< a root that was given up,
  std::uint16_t gone_round_ = 0; ///< and its last round: older ones still go round
  std::vector<reception> receptions_;
  std::uint16_t sequence_ = 0; ///< of our last stamp
  std::optional<instant> sent_at_;
  unsigned hurried_ = 0; ///< stamps left that follow each other quickly
  instant due_;
};

} // namespace rubicon::smepp
