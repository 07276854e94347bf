// Who owns which active-message type on the radio and on the serial line (AM-05).
#pragma once

#include <cstdint>

namespace rubicon::network::am {

inline constexpr std::uint8_t component_management = 0x10; ///< join, leave, keep-alive
inline constexpr std::uint8_t local = 0x11;                ///< between two neighbours of one island
inline constexpr std::uint8_t to_gateway = 0x12;   ///< an island packet on its way up (WIR-01)
inline constexpr std::uint8_t from_gateway = 0x13; ///< an island packet on its way down
inline constexpr std::uint8_t sink_event = 0x14;   ///< between a sink and its gateway only
inline constexpr std::uint8_t beacon = 0x15;       ///< one hop: links, tree, coordinates, clock
inline constexpr std::uint8_t up = 0x16;           ///< along the tree to the sink
inline constexpr std::uint8_t down = 0x17;         ///< from the sink along a route
inline constexpr std::uint8_t flood = 0x18;        ///< to every mote of the island
inline constexpr std::uint8_t channel = 0x19;      ///< one hop of a channel (NET-01..09)
inline constexpr std::uint8_t packet = 0x1a; ///< a fragment of an island packet, inside the tree or
                                             ///< on the serial line
inline constexpr std::uint8_t outputs_wanted = 0x1b; ///< from a gateway to a mote, above Transport
inline constexpr std::uint8_t smepp =
    0x1c; ///< between two neighbours, secured (smepp/crypto/security.hpp)

} // namespace rubicon::network::am
