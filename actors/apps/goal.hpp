// A program that pursues goals, on the peer of a robot that is not there (SVC-10). It knows tuples
// and nothing else.
#pragma once

#include <cstdint>
#include <string>

#include "actors/messages.hpp"
#include "actors/timer.hpp"
#include "goal/pursuer.hpp"

namespace rubicon {

/// What the actor of a pursuer is made of.
struct pursuer_arguments {
  goal::pursuer core;
  std::string who;     ///< the peer's name, for the report
  peer_id peer_number; ///< of the kernel it uses
  peis_peer_actor peer;
  ecology_actor ecology;
};

struct pursuer_state {
  pursuer_arguments arguments;
  timer wake;
};

timed_peer_app_actor::behavior_type
pursuer_behavior(scheduler::traced_pointer<pursuer_state, timed_peer_app_actor> self,
                 pursuer_arguments arguments);

} // namespace rubicon
