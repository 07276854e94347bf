// How large a node's tables are for the programs on it: as a mote's firmware is compiled for what
// it is to run.
#pragma once

#include <vector>

#include "apps/app_config.hpp"
#include "apps/traffic.hpp"
#include "communication/layer.hpp"
#include "network/router.hpp"

namespace rubicon::apps {

/// Makes tables larger where the defaults have no room for all streams and synaptic channels of
/// these programs.
void make_room(communication::layer_config& tables, const std::vector<app_config>& programs);

/// @returns how many streams, or synaptic channels in each direction, these programs of a PC want,
/// and `least` at least
[[nodiscard]] std::size_t ends_max(std::size_t least, const std::vector<app_config>& programs);

/// So many channels of others may pass a mote at least, if its island has as many.
inline constexpr std::size_t passing_channels_max = 64;

/// The same for channels that begin, end or pass at a mote or sink, and for the vectors of a tick
/// that wait for its radio.
/// @param own of the mote's programs
void make_room(network::router_config& tables, const traffic& own, const traffic& of_island);

} // namespace rubicon::apps
