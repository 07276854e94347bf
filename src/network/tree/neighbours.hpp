// Whose frames are received, and how well, in both directions: the link estimator.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/address.hpp"
#include "core/describe/fields.hpp"
#include "core/time.hpp"

namespace rubicon::network {

/// A share of frames that arrive, in 65535ths.
using quality = std::uint16_t;

inline constexpr quality quality_max = 65535;

[[nodiscard]] constexpr quality quality_of(double share) {
  return static_cast<quality>(share * quality_max);
}

/// Expected transmissions, in 128ths (the metric of paths over several hops: De Couto's ETX).
using etx_cost = std::uint16_t;

inline constexpr etx_cost etx_one = 128;
inline constexpr etx_cost etx_infinite = 65535; ///< no route
/// Of a backbone: no radio link costs less, and costs still fall along each route.
inline constexpr etx_cost etx_backbone = 1;

struct neighbours_config {
  std::size_t capacity = 12;            ///< what a mote has room for
  std::uint8_t good_samples = 6;        ///< beacons that a link must have shown to be good
  std::uint8_t usable_samples = 3;      ///< beacons from which on it has an ETX
  quality good_from = quality_of(0.85); ///< in both directions: the link becomes good
  quality bad_below = quality_of(0.7);  ///< in either direction: it no longer is
  static constexpr quality usable_from = quality_of(0.1); ///< in * out, the least that has an ETX
  std::uint8_t unusable_missed =
      2; ///< beacons overdue in a row: no ETX; one more below 3/4, two below 1/2
  std::uint8_t bad_missed = 3;                      ///< no longer good
  static constexpr std::uint8_t dropped_missed = 8; ///< forgotten
  /// Beacons not listing us: it does not receive ours.
  static constexpr std::uint8_t unmentioned_max = 6;
  duration beacon_gap_max = 12min; ///< longest between two beacons: 1.5 intervals of 8 min
  duration beacon_slack = 250ms;   ///< by which a beacon may come late
  /// After a longer gap of sequence numbers the link is estimated anew. Back, or to one of the
  /// first so many, it is a restart.
  static constexpr std::uint16_t sequence_gap_max = 32;
  /// Those at the other ends of backbones: their links are as good as they are there.
  std::vector<mote_id> backbone = {};
  /// Least between evictions for links that do not matter.
  static constexpr duration replacement_gap = 10s;
};

/// What a beacon says that concerns the link.
struct link_report {
  mote_id source;
  std::uint16_t sequence = 0;           ///< counts its beacons
  duration next{};                      ///< its next beacon comes within this time
  std::optional<std::uint8_t> hears_us; ///< in 255ths; nothing: we are not in this beacon's list
  bool matters =
      false; ///< of the two ends of the link one has a route to the sink and one has none
  bool is_sink = false;    ///< there is always room for it
  bool is_crowded = false; ///< it receives so many that there may be no room for us in its table
};

struct neighbour {
  mote_id mote;
  std::uint16_t sequence = 0;   ///< of its last beacon
  quality in = 0;               ///< of its beacons that we receive
  std::uint8_t samples = 0;     ///< beacons behind `in`, up to 255
  std::optional<quality> out;   ///< of ours that it receives, as it reports
  std::uint8_t unmentioned = 0; ///< beacons in a row that did not list us
  quality data = 0;             ///< of our unicasts that it acknowledges
  std::uint8_t data_weight = 0; ///< of `data`, in 16ths; the rest is in * out
  std::uint8_t missed = 0;      ///< beacons overdue in a row
  bool good = false;
  bool pinned = false;
  bool crowded = false; ///< as in link_report
  instant heard;        ///< last
  instant due;          ///< the next beacon counts as missed from here on
  duration period{};    ///< that was expected for it
};

/// What has become of a beacon's sender.
enum class admission : std::uint8_t {
  known,
  added,     ///< new in the table, or after a long gap: beacon soon, so that the link gets to work
  replaced,  ///< new in the table, for another that was evicted; no hurry
  restarted, ///< its sequence number leapt: all that was known about it is forgotten; beacon soon
  repeated,  ///< the same beacon again: nothing learnt
  refused,   ///< the table is full of better ones
};

struct neighbours_counters {
  std::uint64_t evicted = 0;
  std::uint64_t refused = 0;
  std::uint64_t restarted = 0;
  std::uint64_t repeated = 0;
  std::uint64_t dropped = 0; ///< fallen silent
};
RUBICON_FIELDS(neighbours_counters, evicted, refused, restarted, repeated, dropped);

/// The table of neighbours, ascending by id.
///
/// `in` is (beacons received + 1/2) / (beacons sent + 1), so that a few samples prove little, and
/// from the 15th beacon on an EWMA of weight 1/16. Gaps in the sequence numbers and beacons that do
/// not come when their sender said count as sent and not received.
///
/// A full table makes room for a newcomer by evicting, never a pinned neighbour, the first that
/// there is of: the most overdue, if unusable; of those with good_samples beacons the weakest that
/// does not receive ours; the weakest that is not good; if the newcomer's link matters, the
/// weakest; if it is the sink, the weakest of whatever age. Ties evict the highest id. Else the
/// newcomer is refused, as it is, unless its link matters, within replacement_gap of the last
/// eviction for such a one.
class neighbours {
public:
  neighbours() = default;
  explicit neighbours(neighbours_config config) : config_(config) {}

  admission on_beacon(const link_report& x, instant now);

  /// A unicast to a neighbour has ended after so many transmissions (NET-09); others are ignored.
  void on_sent(mote_id to, bool acked, unsigned transmissions, instant now);

  /// A frame of it has come that is no beacon: it is there.
  void hear(mote_id from, instant now);

  /// @returns who has been dropped for silence, ascending
  std::vector<mote_id> on_time(instant now);

  /// When on_time() is due; nothing without neighbours.
  [[nodiscard]] std::optional<instant> deadline() const { return deadline_; }

  /// Counts whatever changes what is known of a link.
  [[nodiscard]] std::uint64_t changes() const { return changes_; }

  /// Neighbours that have left the table so far, dropped or evicted: who keeps something for each
  /// neighbour has nothing to forget while this stays as it is.
  [[nodiscard]] std::uint64_t departures() const { return counters_.evicted + counters_.dropped; }

  /// Keeps a neighbour from being evicted for another (parent, children, next hops), or no longer.
  /// It is still dropped if it falls silent.
  void pin(mote_id mote, bool pinned);

  /// The next `count` at most of those to list in our beacon; takes turns.
  struct heard_entry {
    mote_id mote;
    std::uint8_t quality = 0; ///< in 255ths

    friend bool operator==(const heard_entry&, const heard_entry&) = default;
  };
  [[nodiscard]] std::vector<heard_entry> heard(std::size_t count);

  /// Of a link that is usable now; at least etx_min().
  [[nodiscard]] std::optional<etx_cost> etx(mote_id mote) const;
  [[nodiscard]] std::optional<etx_cost> etx(const neighbour& x) const;

  /// The least that a link to this mote can cost, however good it is.
  [[nodiscard]] etx_cost etx_min(mote_id mote) const {
    return has_backbone(mote) ? etx_backbone : etx_one;
  }
  [[nodiscard]] bool has_backbone(mote_id mote) const {
    return std::ranges::find(config_.backbone, mote) != config_.backbone.end();
  }

  /// Both directions deliver well: what coordinates and greedy routing count as a link (NET-11).
  [[nodiscard]] bool good(mote_id mote) const;

  [[nodiscard]] const neighbour* find(mote_id mote) const;
  [[nodiscard]] const std::vector<neighbour>& all() const { return table_; }
  [[nodiscard]] bool is_full() const { return table_.size() >= config_.capacity; }
  [[nodiscard]] const neighbours_config& config() const { return config_; }
  [[nodiscard]] const neighbours_counters& counters() const { return counters_; }

  /// Octets of the full table on a mote.
  [[nodiscard]] std::size_t footprint() const;

private:
  [[nodiscard]] neighbour* entry(mote_id mote);
  [[nodiscard]] static std::optional<quality> likely_out(const neighbour& x);
  [[nodiscard]] quality both_ways(const neighbour& x) const;
  [[nodiscard]] bool is_silent(const neighbour& x) const;
  [[nodiscard]] static bool fails(const neighbour& x);
  void sample(neighbour& x, bool heard) const;
  [[nodiscard]] duration gap_max(const neighbour& x) const;
  void judge(neighbour& x) const;
  void take_report(neighbour& x, const link_report& report, instant now) const;
  void alive(neighbour& x, instant now);
  void refresh_deadline();
  [[nodiscard]] bool make_room(const link_report& x, instant now);
  bool evict(std::vector<neighbour>::iterator x);
  admission admit(const link_report& x, instant now);

  neighbours_config config_;
  std::vector<neighbour> table_;
  std::optional<instant> deadline_; ///< the earliest `due`
  std::uint64_t changes_ = 0;
  mote_id listed_last_;             ///< in the list of our last beacon
  std::optional<instant> replaced_; ///< when the last eviction for a link that does not matter was
  neighbours_counters counters_;
};

} // namespace rubicon::network
