// Moves connectionless traffic hop by hop, each hop repeated until the next mote has it: up the
// tree to the sink, down along the route the sink has chosen, and to everybody (NET-05, ADR-05).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "core/account/provenance.hpp"
#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/describe/fields.hpp"
#include "core/numbers/random.hpp"
#include "core/time.hpp"
#include "network/tree/collection_packet.hpp"
#include "network/tree/sequence_windows.hpp"
#include "network/tree/source_routes.hpp"
#include "network/wire.hpp"

namespace rubicon::network {

struct collection_config {
  mote_id self;
  bool is_root = false;
  std::size_t queue_max = 8;    ///< packets that wait for their hop, others' and our own
  std::size_t octets_max = 352; ///< of the content of these and the one in flight: a longest
                                ///< packet in its fragments, or eight readings
  std::size_t seen_max = 8;     ///< packets remembered, so that a repeat is not sent on again
  /// Times a packet is handed to the radio, which itself tries four times, before it is given up.
  unsigned rounds_max = 8;
  duration pause = 40ms; ///< before the second round, up to twice as long; more before each further
  static constexpr duration route_wait = 1s; ///< without a route up; a round each
  duration flood_spread = 40ms; ///< motes that send the same flood on do so within this time
  static constexpr unsigned flood_copies = 2; ///< each mote sends a flood on so often
  std::uint8_t hops_max = 32;
};

struct collection_counters {
  std::uint64_t originated = 0;
  std::uint64_t arrived = 0; ///< for us
  std::uint64_t forwarded = 0;
  std::uint64_t repeated = 0; ///< rounds after the first
  std::uint64_t duplicates = 0;
  std::uint64_t loops = 0; ///< came from a mote that is no farther from the sink than we are
  std::uint64_t malformed = 0;
  // Packets lost here.
  std::uint64_t queue_full = 0;
  std::uint64_t gave_up = 0;  ///< all rounds failed
  std::uint64_t no_route = 0; ///< down: the mote is not known, or too far; up: none for too long
  std::uint64_t too_far = 0;  ///< hops_max made
};
RUBICON_FIELDS(collection_counters, originated, arrived, forwarded, repeated, duplicates, loops,
               malformed, queue_full, gave_up, no_route, too_far);

/// Hand this frame to the radio and notify on_sent() how it ended.
struct hop {
  mote_id next; ///< broadcast_mote: to all, not acknowledged
  std::uint8_t am_type = 0;
  bytes octets;
  bool in_slot = false; ///< as in radio::request
  provenance from = {};
};

/// For us.
struct collected {
  mote_id origin; ///< the sink for what came down
  bool by_flood = false;
  bytes content;
};

using collection_output = std::variant<hop, collected>;
using collection_outputs = std::vector<collection_output>;

/// One frame is in flight at a time. A queue that is full drops what comes, and counts it: who must
/// know is told end to end (MCK-12). But packets up whose content does not begin with 0, which the
/// Network modules send for themselves (router_message.hpp), give way to those whose content does.
class collection {
public:
  collection() = default;
  collection(collection_config config, random_stream rng);

  /// How much content fits one packet to the sink, or down such a route, or for everybody.
  [[nodiscard]] static std::size_t room_up() { return frame_payload_max - up_packet::header_size; }
  [[nodiscard]] static std::size_t room_flood() {
    return frame_payload_max - flood_packet::header_size;
  }
  /// Nothing if the mote is not known. @pre is_root
  [[nodiscard]] std::optional<std::size_t> room_down(mote_id to) const;

  /// @pre not is_root, content.size() <= room_up()
  /// @param in_slot as in channels::send()
  [[nodiscard]] collection_outputs send_up(bytes content, instant now, bool in_slot = false);
  /// @pre is_root, content.size() <= room_down(to)
  [[nodiscard]] collection_outputs send_down(mote_id to, bytes content, instant now);
  /// @pre content.size() <= room_flood()
  [[nodiscard]] collection_outputs send_to_all(bytes content, instant now);

  /// A frame of one of the three AM types.
  [[nodiscard]] collection_outputs on_frame(mote_id from, std::uint8_t am_type, byte_view octets,
                                            instant now);

  /// Until then only frames in slots are handed out.
  void hold(instant until) { held_until_ = until; }

  /// The hop that was handed out has ended.
  [[nodiscard]] collection_outputs on_sent(bool acked, instant now);

  /// Where the route up leads from now on; no_mote: nowhere.
  [[nodiscard]] collection_outputs on_route(mote_id parent, etx_cost cost, instant now);

  [[nodiscard]] collection_outputs on_time(instant now); ///< harmless before deadline()
  [[nodiscard]] std::optional<instant> deadline() const;

  /// A loop was seen since the last call: our beacon should come soon.
  [[nodiscard]] bool take_loop_seen() { return std::exchange(loop_seen_, false); }

  [[nodiscard]] source_routes& routes() { return routes_; } ///< of the root
  [[nodiscard]] const source_routes& routes() const { return routes_; }
  [[nodiscard]] std::size_t queued() const { return queue_.size(); }
  [[nodiscard]] const collection_counters& counters() const { return counters_; }
  [[nodiscard]] std::size_t footprint() const {
    // beside its content, a packet has a kind, a header of 9 octets, rounds, and when it is due
    return config_.octets_max + (config_.queue_max + 1) * (1 + 9 + 1 + 2) + config_.seen_max * 6 +
           40;
  }

private:
  /// Distinguishes a packet from all others for a while. A packet that went round a loop is another
  /// one.
  struct mark {
    std::uint8_t am_type = 0;
    mote_id mote;
    std::uint16_t sequence = 0;
    std::uint8_t hops = 0;

    friend bool operator==(const mark&, const mark&) = default;
  };

  struct waiting {
    std::variant<up_packet, down_packet, flood_packet> packet;
    unsigned rounds = 0;
    instant due;
    bool in_slot = false; ///< in its first round
    provenance from = {};
  };

  [[nodiscard]] static bool gives_way(const waiting& x);
  void enqueue(waiting x);
  [[nodiscard]] std::size_t octets() const;
  [[nodiscard]] instant due(const waiting& x) const;
  [[nodiscard]] bool is_new(const mark& x);
  void take(up_packet x, collection_outputs& out, instant now);
  void take(down_packet x, collection_outputs& out, instant now);
  void take(flood_packet x, collection_outputs& out, instant now);
  void pump(collection_outputs& out, instant now);
  [[nodiscard]] std::optional<hop> hop_of(waiting& x) const;
  [[nodiscard]] duration pause_after(unsigned rounds);

  collection_config config_;
  random_stream rng_;
  source_routes routes_;
  mote_id parent_ = no_mote;
  etx_cost cost_ = etx_infinite;
  std::uint16_t sequence_ = 0;
  std::vector<waiting> queue_;
  std::optional<waiting> in_flight_;
  instant held_until_;
  std::vector<mark> seen_;
  sequence_windows arrived_; ///< at the root
  bool loop_seen_ = false;
  collection_counters counters_;
};

} // namespace rubicon::network
