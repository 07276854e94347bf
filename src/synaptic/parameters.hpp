// What `params` of create_syn_channel_out and _in says (D1.1 5.3.1; SYN-13, A-43).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/address.hpp"
#include "core/describe/fields.hpp"

namespace rubicon::synaptic {

/// DIM_SYNCHANNEL_PARAM, octets.
inline constexpr std::size_t parameters_size = 10;

/// All zeros: the own island, a vector every tick, nothing asked of the channel service.
struct parameters {
  island_id island = own_island; ///< octets 0..1, network order; 0, like 255: the own one
  std::uint8_t divisor = 1;      ///< octet 2: a vector at every so many ticks; 0 there is 1
  std::uint8_t qos = 0;          ///< octet 3: stream::qos_*, for who provides the channel

  friend bool operator==(const parameters&, const parameters&) = default;
};
RUBICON_FIELDS(parameters, island, divisor, qos);

/// Octets 4..9 are reserved: written as 0, not looked at.
/// @pre x.island fits into two octets
[[nodiscard]] std::array<std::uint8_t, parameters_size> encode(const parameters& x);
[[nodiscard]] parameters parse_parameters(std::span<const std::uint8_t, parameters_size> octets);

} // namespace rubicon::synaptic
