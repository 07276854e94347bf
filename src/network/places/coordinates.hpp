// Virtual coordinates by hop distances to three elected anchors: VCap (Caruso, Chessa, De, Urpi,
// "GPS free coordinate assignment and routing"; D1.1 3.3.3.1 [5], NET-10, NET-11).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/address.hpp"
#include "core/codec.hpp"
#include "core/describe/fields.hpp"
#include "core/time.hpp"
#include "network/tree/feasibility.hpp"
#include "network/tree/neighbours.hpp"

namespace rubicon::network {

/// Hops over good links; hops_unknown: none known, or more than hop_distance_max.
using hop_distance = std::uint8_t;

inline constexpr hop_distance hops_unknown = 255;
inline constexpr hop_distance hop_distance_max = 126;

/// Hop distances to the anchors X, Y and Z.
struct virtual_coordinates {
  hop_distance x = 0;
  hop_distance y = 0;
  hop_distance z = 0;

  friend auto operator<=>(const virtual_coordinates&, const virtual_coordinates&) = default;
};

/// The square of the Euclidean distance.
[[nodiscard]] std::uint32_t squared_distance(virtual_coordinates a, virtual_coordinates b);

/// There are no fewer hops between them: neighbours differ by one in each coordinate, at most.
[[nodiscard]] int hops_between(virtual_coordinates a, virtual_coordinates b);

/// One anchor as in a beacon: 5 octets, the last one with was_bit or hops_unknown.
struct anchor_entry {
  mote_id mote = no_mote;           ///< no_mote: not elected yet
  std::uint16_t sequence = 0;       ///< counted up by the anchor with each of its beacons
  hop_distance hops = hops_unknown; ///< from the beacon's sender
  /// The sender knows no route now; when it last did it was so far. Says where the sender is, and
  /// nothing of routes.
  bool was = false;

  static constexpr std::uint8_t was_bit = 0x80;

  friend bool operator==(const anchor_entry&, const anchor_entry&) = default;
};

/// Whom a mote would make the next anchor: 4 octets. A greater (score, tie) wins, then the lower
/// id.
struct anchor_candidate {
  mote_id mote = no_mote; ///< no_mote: none
  std::uint8_t score = 0;
  std::uint8_t tie = 0;

  friend bool operator==(const anchor_candidate&, const anchor_candidate&) = default;
};

[[nodiscard]] bool is_better(const anchor_candidate& a, const anchor_candidate& b);

/// W is the sink.
enum anchor : std::uint8_t { anchor_w, anchor_x, anchor_y, anchor_z };

inline constexpr std::size_t anchor_count = 4;

/// The coordinates part of a beacon: 26 octets.
struct coordinates_part {
  std::uint16_t epoch = 0; ///< counts the sink's decisions who X, Y and Z are
  std::array<anchor_entry, anchor_count> anchors;
  anchor_candidate candidate;

  static constexpr std::size_t size = 2 + 5 * anchor_count + 4;

  void write(byte_writer& out) const;
  [[nodiscard]] static coordinates_part read(byte_reader& in);

  friend bool operator==(const coordinates_part&, const coordinates_part&) = default;
};

struct coordinates_config {
  mote_id self;
  bool is_sink = false;
  static constexpr duration first_quiet = 60s; ///< before the sink's first decision
  static constexpr duration quiet = 40s; ///< for which a candidate must stay the best at the sink
  /// Beacons of a neighbour before a sink believes to be alone.
  static constexpr std::uint8_t company_samples = 6;
  duration anchor_patience = 2min;    ///< without a route to an anchor: the sink elects all anew
  duration sequence_patience = 30min; ///< without news of an anchor: there is no route to it
};

struct coordinates_counters {
  std::uint64_t elections = 0;     ///< started anew, at the sink
  std::uint64_t foreign_sinks = 0; ///< beacons with another W than ours
  std::uint64_t changes = 0;       ///< of our distances
};
RUBICON_FIELDS(coordinates_counters, elections, foreign_sinks, changes);

/// Distances: a mote's distance to an anchor is the least of its good neighbours' and one, over
/// feasible rows (see feasibility), so that no mote counts to infinity when an anchor or link dies.
///
/// Election: X is the mote farthest from W, Y the one farthest from X, Z the one whose nearer of X
/// and Y is farthest, then the one with the greatest sum of both; ties go to the lowest id. Any
/// mote can be any anchor, so that islands of one, two or three motes need no exception. Each mote
/// names in its beacons the best candidate among itself and what its good neighbours farther from W
/// name; nothing is remembered, so that what is wrong vanishes with its cause. The best of all
/// arrives at the sink, which makes it the next anchor when it has been the best for a quiet
/// period. Its decisions are an epoch and three ids, which every beacon carries on; the newest
/// epoch wins.
///
/// The sink elects anew when it has had no route to an anchor for anchor_patience, and when the
/// island has grown so that the mote farthest from W is more than half as far again as X, and a
/// hop. A sink that has restarted goes on with the epoch and anchors that it receives from its
/// neighbours.
class coordinates {
public:
  coordinates() = default;
  explicit coordinates(coordinates_config config, instant now);

  /// @pre the neighbours have seen the beacon; if they refused its sender, only decisions of the
  /// sink are taken from it
  void on_beacon(mote_id source, const coordinates_part& x, const neighbours& links);

  /// Computes everything anew. To be called after beacons, changes of links and at deadline().
  /// @returns whether what our beacons say has changed: beacon soon
  [[nodiscard]] bool update(const neighbours& links, instant now);

  /// When update() is due though nothing has come.
  [[nodiscard]] std::optional<instant> deadline() const;

  /// For a beacon that is sent now.
  [[nodiscard]] coordinates_part advertise();

  /// Ours; nothing while an anchor is missing.
  [[nodiscard]] std::optional<virtual_coordinates> place() const;

  /// A neighbour's, as it advertised last; nothing if it does not know them or follows another
  /// epoch.
  [[nodiscard]] std::optional<virtual_coordinates> place_of(mote_id neighbour) const;

  /// The same, or where it was last: an anchor may be out of reach for a while, as long as a mote
  /// in between restarts, and no mote has moved; and until all anchors of a new epoch are elected,
  /// everybody goes by those of the one before.
  [[nodiscard]] std::optional<virtual_coordinates> likely_place() const { return last_place_; }
  [[nodiscard]] std::optional<virtual_coordinates> likely_place_of(mote_id neighbour) const;

  /// likely_place(); a mote that has just started, and has no good links yet, concludes it from the
  /// places of those that it receives. Too far from an anchor while these are few: for its own
  /// decisions.
  [[nodiscard]] std::optional<virtual_coordinates> presumed_place() const;

  /// The greedy step (NET-10): the good neighbour closest to `destination` in coordinate space and
  /// closer than this mote, of equals the lowest id; nothing at a dead end.
  [[nodiscard]] std::optional<mote_id> greedy_step(virtual_coordinates destination,
                                                   const neighbours& links) const;

  /// no_mote: not elected.
  [[nodiscard]] mote_id anchor_id(anchor x) const { return states_[x].mote; }
  [[nodiscard]] hop_distance hops_to(anchor x) const { return states_[x].hops; }
  [[nodiscard]] std::uint16_t epoch() const { return epoch_; }
  [[nodiscard]] std::uint16_t place_epoch() const { return place_epoch_; } ///< of likely_place()
  [[nodiscard]] const coordinates_counters& counters() const { return counters_; }

  /// Octets of the state on a mote with `capacity` neighbours.
  [[nodiscard]] static std::size_t footprint(std::size_t capacity);

private:
  struct row {
    mote_id mote;
    coordinates_part part;
    std::optional<virtual_coordinates> place{}; ///< the last known
  };

  struct state {
    mote_id mote = no_mote;
    hop_distance hops = hops_unknown;
    std::uint16_t sequence = 0;
    instant progressed; ///< when `sequence` last went up
    feasibility advertised;
  };

  [[nodiscard]] const row* find(mote_id neighbour) const;
  [[nodiscard]] std::optional<virtual_coordinates> last_place_in(const row& x) const;
  void prune(const neighbours& links);
  void take_decisions(const coordinates_part& x);
  void decide(std::uint16_t epoch, const std::array<mote_id, anchor_count>& anchors);
  void note_own_sequence(const coordinates_part& x);
  [[nodiscard]] bool speaks_of(const row& x, std::size_t anchor) const;
  void measure(std::size_t anchor, const neighbours& links, instant now);
  [[nodiscard]] bool is_stale(const state& x, instant now) const;
  [[nodiscard]] bool waits(instant now) const;
  [[nodiscard]] anchor_candidate own_candidate() const;
  [[nodiscard]] anchor_candidate best_candidate(const neighbours& links) const;
  [[nodiscard]] bool is_complete() const;
  [[nodiscard]] bool has_lost_anchor(instant now);
  [[nodiscard]] bool may_get_company(const neighbours& links) const;
  void elect(const neighbours& links, instant now);

  coordinates_config config_;
  std::vector<row> rows_;        ///< one for each neighbour at most, ascending
  std::uint64_t departures_ = 0; ///< of neighbours, when rows_ was pruned
  /// neighbours::changes() as the last update() saw it, if nothing has changed here since
  std::optional<std::uint64_t> settled_;
  std::uint16_t epoch_ = 0;
  std::uint16_t own_sequence_ = 0; ///< as an anchor
  std::array<state, anchor_count> states_;
  anchor_candidate candidate_; ///< the best we know of
  std::optional<virtual_coordinates> last_place_;
  std::uint16_t place_epoch_ = 0;
  coordinates_counters counters_;

  bool changed_ = false; ///< since the last update()

  // at the sink
  instant first_from_;                        ///< no decision before
  instant quiet_from_;                        ///< candidate_ has been the best since
  std::array<instant, anchor_count> reached_; ///< when there last was a route to the anchor
};

} // namespace rubicon::network
