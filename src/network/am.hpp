// Who owns which active-message type on the radio and on the serial line (AM-05).
#pragma once

#include <cstdint>

namespace rubicon::network::am {

inline constexpr std::uint8_t component_management = 0x10; ///< join, leave, keep-alive
inline constexpr std::uint8_t local = 0x11;        ///< a segment between two motes of one island
inline constexpr std::uint8_t to_gateway = 0x12;   ///< an island packet on its way up (WIR-01)
inline constexpr std::uint8_t from_gateway = 0x13; ///< an island packet on its way down
inline constexpr std::uint8_t sink_event = 0x14;   ///< between a sink and its gateway only

} // namespace rubicon::network::am
