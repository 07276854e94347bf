// The collection tree: which neighbour is the next on the cheapest route to the sink.
#pragma once

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

/// What a beacon says about its sender's route to the sink: 9 octets.
struct gradient_part {
  mote_id root = no_mote;          ///< the sink; no_mote: none known
  std::uint16_t root_sequence = 0; ///< counted up by the root with each of its beacons
  mote_id parent = no_mote;        ///< no_mote: is the root, or has no route
  etx_cost cost = etx_infinite;    ///< etx_infinite: no route, do not send through me
  std::uint8_t hops = 0;           ///< below 128
  /// The sequence number was asked for: who has it from this mote passes it on soon.
  bool urgent = false;

  static constexpr std::size_t size = 9;

  void write(byte_writer& out) const;
  [[nodiscard]] static gradient_part read(byte_reader& in);

  friend bool operator==(const gradient_part&, const gradient_part&) = default;
};

struct gradient_config {
  mote_id self;
  bool is_root = false;
  std::uint8_t hops_max = 64;
  static constexpr etx_cost hysteresis = etx_one / 4; ///< that another parent must be better by
  duration root_patience = 20min; ///< without a newer root sequence number: the root is gone
  /// So often, without a route, we may hear our root count on behind what we take for its number
  /// before we believe that the number was never its own.
  static constexpr std::uint8_t behind_max = 8;
};

struct gradient_counters {
  std::uint64_t parent_changes = 0; ///< from one parent to another
  std::uint64_t losses = 0;         ///< from a parent to none
  std::uint64_t foreign_roots = 0;  ///< beacons with another root than ours
  std::uint64_t forgotten = 0;      ///< numbers of the root that were not its own
};
RUBICON_FIELDS(gradient_counters, parent_changes, losses, foreign_roots, forgotten);

enum class gradient_change : std::uint8_t {
  none,
  parent, ///< another parent, or the first
  lost, ///< the parent is gone and there is no other: beacon at once, so that no mote relies on us
};

/// Minimises the sum of ETX to the root, with hysteresis, over feasible routes only (see
/// feasibility): what motes advertise never closes a loop. Equal costs are decided by hops,
/// then by the lower id.
class gradient {
public:
  gradient() = default;
  explicit gradient(gradient_config config);

  /// @pre the neighbours have seen the beacon; if they refused its sender it is ignored here too.
  /// @param restarted the sender has forgotten what it advertised before
  /// @returns whether our own beacon should come soon: we can help the sender to a route
  bool on_beacon(mote_id source, const gradient_part& x, const neighbours& links,
                 bool restarted = false);

  /// Chooses the parent anew. To be called after beacons, ends of unicasts and dropped neighbours.
  [[nodiscard]] gradient_change update(const neighbours& links, instant now);

  /// For a beacon that is sent now.
  [[nodiscard]] gradient_part advertise();

  /// Somebody waits for our next sequence number: the next advertise() says so. @pre is_root()
  void hasten() { urgent_ = true; }
  /// A sequence number that somebody waits for has come, and has not been advertised yet.
  [[nodiscard]] bool is_urgent() const { return urgent_; }

  /// Whether a neighbour that has just beaconed waits, not for the first time, for a newer sequence
  /// number than we could advertise.
  [[nodiscard]] bool starves(mote_id neighbour) const;

  [[nodiscard]] bool has_route() const { return cost_ != etx_infinite; }
  [[nodiscard]] bool is_root() const { return config_.is_root; }
  [[nodiscard]] mote_id root() const { return root_; }
  [[nodiscard]] mote_id parent() const { return parent_; } ///< no_mote: none, or is the root
  [[nodiscard]] etx_cost cost() const { return cost_; }
  [[nodiscard]] std::uint8_t hops() const { return hops_; }

  /// Costs fall along a sound path. @returns whether a packet that was sent on by a mote of this
  /// cost has come to one that is no nearer to the root: somebody's picture is old, beacon soon
  [[nodiscard]] bool is_loop(etx_cost packet_cost) const {
    return has_route() && packet_cost <= cost_;
  }

  /// Neighbours that have this mote as their parent, ascending.
  [[nodiscard]] std::vector<mote_id> children() const;

  [[nodiscard]] const gradient_counters& counters() const { return counters_; }

  /// Octets of the state on a mote with `capacity` neighbours: a row stands beside the neighbour's
  /// own, whose id it needs not repeat.
  [[nodiscard]] static std::size_t footprint(std::size_t capacity) {
    return gradient_part::size * capacity + 24;
  }

private:
  struct row {
    mote_id mote;
    gradient_part part;
    /// The least cost that it has advertised with this sequence number. None of those who may use
    /// its route advertises less, so it never goes through them, whatever it costs now.
    etx_cost least = etx_infinite;
    unsigned lost = 0; ///< beacons in a row in which it had no route
  };

  struct offer {
    const row* from = nullptr; ///< nullptr: none
    etx_cost cost = etx_infinite;
  };

  [[nodiscard]] offer offer_of(const row& x, const neighbours& links, mote_id root,
                               instant now) const;
  [[nodiscard]] offer kept_offer(const neighbours& links, instant now) const;
  /// Of offers below that cost; may find others too.
  [[nodiscard]] offer best_offer(const neighbours& links, mote_id root, int below,
                                 instant now) const;
  [[nodiscard]] offer choose(const neighbours& links, instant now);
  void follow(const offer& chosen, instant now);
  [[nodiscard]] bool is_stale(instant now) const;
  void note_progress(const row& old, const gradient_part& x);
  void prune(const neighbours& links);

  gradient_config config_;
  std::vector<row> rows_;        ///< one for each neighbour at most, ascending
  std::uint64_t departures_ = 0; ///< of neighbours, when rows_ was pruned
  /// neighbours::changes() as the last update() saw it, if nothing has changed here since
  std::optional<std::uint64_t> settled_;
  mote_id root_ = no_mote;
  mote_id parent_ = no_mote;
  etx_cost cost_ = etx_infinite;
  std::uint8_t hops_ = 0;
  std::uint16_t sequence_ = 0; ///< of the root, that we advertise
  instant progressed_;         ///< when it last went up
  feasibility advertised_;
  bool urgent_ = false;
  std::uint8_t behind_ = 0; ///< as for behind_max, in a row
  gradient_counters counters_;
};

} // namespace rubicon::network
