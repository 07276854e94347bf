// The air: the radio medium of one place and the radios in it (design.md section 4).
#pragma once

#include <functional>
#include <vector>

#include "actors/messages.hpp"
#include "actors/timer.hpp"
#include "radio/channel.hpp"

namespace rubicon {

/// Told of every frame when it has ended; must not touch the ecology.
using frame_observer = std::function<void(const radio::overheard&)>;

struct air_state {
  radio::channel channel;
  frame_observer observe;
  std::vector<radio_user_actor> users; ///< by radio index; empty until attached
  std::vector<mote_address> addresses; ///< by radio index
  ecology_actor ecology;
  timer wake;
};

/// Owns every radio of `channel`. @param addresses whose radio each is, by radio index; the PAN of
/// a radio is its island's id
/// @param observe may be empty
air_actor::behavior_type air(scheduler::traced_pointer<air_state, air_actor> self,
                             radio::channel channel, std::vector<mote_address> addresses,
                             ecology_actor ecology, frame_observer observe);

} // namespace rubicon
