// The messages between gateways of one island, by which any of their ids addresses it (GW-14): PEIS
// port 22. One octet of kind first, network byte order.
#pragma once

#include <cstdint>
#include <variant>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/error.hpp"
#include "core/tuples/device_keys.hpp"
#include "network/island_packet.hpp"

namespace rubicon::gateway {

/// PEIS port of relays.
inline constexpr std::uint16_t relay_port = 22;

/// To the one that leads: this message (WIR-02) has come to a gateway that does not.
struct relayed_message {
  island_id source; ///< where it comes from
  network::gateway_packet packet;

  friend bool operator==(const relayed_message&, const relayed_message&) = default;
};

/// To the one that leads: somebody has written `devices.$ID.input.$CH` at one that does not.
struct relayed_input {
  std::uint32_t number = 0; ///< chosen by who asks; its outcome repeats it
  mote_id mote;
  std::uint16_t channel = 0;
  bytes octets; ///< at most network::body_max

  friend bool operator==(const relayed_input&, const relayed_input&) = default;
};

/// Back: what has become of it; never `pending`.
struct relayed_outcome {
  std::uint32_t number = 0;
  input_outcome outcome = input_outcome::failed;

  friend bool operator==(const relayed_outcome&, const relayed_outcome&) = default;
};

using relay = std::variant<relayed_message, relayed_input, relayed_outcome>;

/// @pre octets that fit
[[nodiscard]] bytes encode(const relay& x);

/// Errors: truncated, too_long, bad_value (source island 0; an outcome that is none), unsupported
/// (unknown kind).
[[nodiscard]] result<relay> decode_relay(byte_view octets);

} // namespace rubicon::gateway
