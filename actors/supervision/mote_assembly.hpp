// The part of the assembly that makes motes.
#pragma once

#include <string>

#include "actors/island/mote.hpp"
#include "actors/messages/air.hpp"
#include "actors/supervision/assembly.hpp"
#include "apps/traffic.hpp"
#include "config/plan/ecology.hpp"
#include "mote/crystal.hpp"

namespace rubicon {

/// @pre the description has an island with this id, here or on another host
[[nodiscard]] const config::island_description& island_described(ecology_pointer self,
                                                                 island_id id);

/// @pre the description has a mote with this address
[[nodiscard]] const config::mote_description& mote_described(ecology_pointer self,
                                                             const mote_address& x);

/// @param who names a mote or a sink
[[nodiscard]] mote::crystal
crystal_of(ecology_pointer self, const config::island_description& island, const std::string& who);

/// Of one mote of an island, whose further sinks have their backbones already.
[[nodiscard]] mote_arguments arguments_of(ecology_pointer self,
                                          const config::island_description& island,
                                          const config::mote_description& mote,
                                          const apps::traffic& traffic, radio::radio_index radio,
                                          const air_actor& air);

/// The motes of an island, in the order of the description, and what the fault plan makes of them.
/// @param radio of the first; each next mote has the next one
void spawn_motes(ecology_pointer self, const config::island_description& island,
                 radio::radio_index radio, const air_actor& air);

/// Traffic of an island with all that the fault plan makes of its motes, or brings there.
[[nodiscard]] apps::traffic traffic_in(ecology_pointer self,
                                       const config::island_description& island);

} // namespace rubicon
