// What carries connectionless traffic between the motes of an island and their sink: up the tree,
// down along a route that the sink has chosen, or to everybody. Network byte order.
#pragma once

#include <cstdint>
#include <vector>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/error.hpp"
#include "network/tree/neighbours.hpp"

namespace rubicon::network {

/// AM type am::up: uint16 origin, uint16 parent of the origin, uint16 sequence, uint16 cost of the
/// mote that sends it on, uint8 hops made; then the content.
struct up_packet {
  mote_id origin;
  mote_id parent;
  std::uint16_t sequence = 0;
  etx_cost cost = 0;
  std::uint8_t hops = 0;
  bytes content;

  static constexpr std::size_t header_size = 9;

  friend bool operator==(const up_packet&, const up_packet&) = default;
};

/// AM type am::down: uint16 sequence, uint8 count of hops (bit 7: they take one octet each), uint8
/// index of the hop that this copy goes to, the hops; then the content.
struct down_packet {
  std::uint16_t sequence = 0;
  std::uint8_t at = 0;
  std::vector<mote_id> hops; ///< the last is the destination; 1 to 32
  bytes content;

  friend bool operator==(const down_packet&, const down_packet&) = default;
};

/// AM type am::flood: uint16 origin, uint16 sequence, uint8 hops made; then the content.
struct flood_packet {
  mote_id origin;
  std::uint16_t sequence = 0;
  std::uint8_t hops = 0;
  bytes content;

  static constexpr std::size_t header_size = 5;

  friend bool operator==(const flood_packet&, const flood_packet&) = default;
};

[[nodiscard]] std::size_t header_size(const std::vector<mote_id>& hops); ///< of a down_packet

[[nodiscard]] bytes encode(const up_packet& x);
[[nodiscard]] bytes encode(const down_packet& x); ///< @pre 1..32 hops, at < hops.size()
[[nodiscard]] bytes encode(const flood_packet& x);

/// Errors: truncated, bad_value (a hop count or index out of range).
[[nodiscard]] result<up_packet> decode_up(byte_view octets);
[[nodiscard]] result<down_packet> decode_down(byte_view octets);
[[nodiscard]] result<flood_packet> decode_flood(byte_view octets);

} // namespace rubicon::network
