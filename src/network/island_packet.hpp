// The two layouts of D1.1 5.4 for messages that leave an island, and ours for the last leg.
#pragma once

#include <cstdint>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/error.hpp"

namespace rubicon::network {

/// Largest body after a 5.4 header: 256 octets of user payload and the 6-octet transport header
/// (WIR-03, WIR-04).
inline constexpr std::size_t body_max = 256 + 6;

/// Octets of the longest packet.
inline constexpr std::size_t packet_max = 8 + body_max;

/// WIR-01, mote to gateway: uint32 island, uint16 mote, uint16 channel, body; network byte order.
/// The same layout carries a message from its gateway down to its mote; there `island` is where it
/// comes from, since 5.4 has no field for that.
struct island_packet {
  island_id island;          ///< up: the target island. Down: the source island.
  mote_id mote;              ///< the target mote in either direction
  std::uint16_t channel = 0; ///< equals the AM type for 0..255
  bytes body;

  friend bool operator==(const island_packet&, const island_packet&) = default;
};

/// WIR-02, gateway to gateway: uint16 mote, uint16 channel, body. The source island is the PEIS id
/// of the sending gateway (WIR-04).
struct gateway_packet {
  mote_id mote;
  std::uint16_t channel = 0;
  bytes body;

  friend bool operator==(const gateway_packet&, const gateway_packet&) = default;
};

/// @pre x.body.size() <= body_max
[[nodiscard]] bytes encode(const island_packet& x);
[[nodiscard]] bytes encode(const gateway_packet& x);

/// Errors: truncated (no complete header), too_long (body above body_max).
[[nodiscard]] result<island_packet> decode_island_packet(byte_view octets);
[[nodiscard]] result<gateway_packet> decode_gateway_packet(byte_view octets);

} // namespace rubicon::network
