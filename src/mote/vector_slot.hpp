// How long a mote's slot must be for what it sends at each tick (SYN-16): the same sums while an
// ecology runs, and where a file is checked.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/time.hpp"
#include "network/slot_time.hpp"
#include "radio/mac_rules.hpp"

namespace rubicon::mote {

/// A vector that leaves at each tick.
struct vector_flow {
  std::size_t elements = 0;
  std::size_t hops = 0; ///< of its channel; 0: it goes through the sink
};

[[nodiscard]] network::access_times access_of(const radio::mac_rules& x);

/// @param packet_max octets (synaptic::channels_config)
[[nodiscard]] duration passage(const vector_flow& x, std::size_t packet_max,
                               const network::access_times& access);

/// The slot that holds them all; 0: there are none.
[[nodiscard]] std::uint16_t units_of(std::span<const vector_flow> flows, std::size_t packet_max,
                                     const network::access_times& access);

} // namespace rubicon::mote
