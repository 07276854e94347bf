// Messages to and from gateways that speak D1.1 5.4 to the letter (WIR-02, WIR-04).
#pragma once

#include <cstdint>
#include <optional>

#include "network/island_packet.hpp"

namespace rubicon::gateway {

/// The message without what 5.4 does not know. Nothing for what cannot be said: channels above
/// 0xff, and whatever is not a plain message, since there are no acknowledgements.
[[nodiscard]] std::optional<network::gateway_packet> to_strict(network::gateway_packet x);

/// The message as our own would have sent it. Its sender within its island is unknown (no_mote).
/// @param counter differs from that of the last message from the same gateway
/// @returns nothing for channels above 0xff and payloads above transport::payload_max
[[nodiscard]] std::optional<network::gateway_packet> from_strict(network::gateway_packet x,
                                                                 std::uint16_t counter);

} // namespace rubicon::gateway
