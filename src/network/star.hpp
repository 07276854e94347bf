// The Network sublayer of a star island: every mote and its sink hear each other.
#pragma once

#include <cstdint>
#include <variant>
#include <vector>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/error.hpp"

namespace rubicon::network {

/// Put this frame on the radio.
struct transmit {
  mote_id next_hop; ///< broadcast_mote for everybody in the island
  std::uint8_t am_type = 0;
  bytes payload;
};

/// A segment for this node.
struct arrived {
  island_id source_island;
  std::uint16_t channel = 0;
  bytes segment;
};

using output = std::variant<transmit, arrived>;
using outputs = std::vector<output>;

struct star_counters {
  std::uint64_t malformed = 0;   ///< frames whose payload could not be decoded
  std::uint64_t misdirected = 0; ///< decoded, but for another mote
  std::uint64_t before_join = 0; ///< segments for the sink while no sink is known
};

/// Moves segments between a mote and its island, or the gateway by way of the sink (RTG-01, 02,
/// 04). Knows neither radio nor clock: a send is one frame, reliability is the radio's and
/// Transport's.
class star {
public:
  star() = default;
  explicit star(mote_id self) : self_(self) {}

  /// Where this node is, as told at join.
  void join(island_id island, mote_id sink);
  void leave() { joined_ = false; }

  /// Sends a segment (at most body_max octets) to a mote of the own island, or to another island or
  /// the gateway through the sink (RTG-04). own_island and own_mote stand for this node's.
  [[nodiscard]] outputs send(mote_address destination, std::uint16_t channel, bytes segment);

  /// A frame of one of this sublayer's AM types (am::local, am::from_gateway) has arrived.
  [[nodiscard]] outputs on_frame(std::uint8_t am_type, byte_view payload);

  /// @returns whether `am_type` belongs to this sublayer
  [[nodiscard]] static bool owns(std::uint8_t am_type);

  [[nodiscard]] bool joined() const { return joined_; }
  [[nodiscard]] mote_address address() const { return {island_, self_}; }
  [[nodiscard]] mote_id sink() const { return sink_; }
  [[nodiscard]] const star_counters& counters() const { return counters_; }

private:
  mote_id self_;
  mote_id sink_ = default_sink;
  island_id island_;
  bool joined_ = false;
  star_counters counters_;
};

} // namespace rubicon::network
