// A component beside a kernel: rules, a translation, a collector, a pursuer of goals, a reader of
// tags. It knows tuples and nothing else.
#pragma once

#include <cstdint>
#include <memory>
#include <set>
#include <string>

#include "actors/base/timer.hpp"
#include "actors/messages/peis.hpp"
#include "actors/messages/services.hpp"
#include "actors/messages/supervision.hpp"
#include "core/component.hpp"

namespace rubicon {

/// What its actor is made of.
struct component_arguments {
  std::shared_ptr<components::component> core; ///< not nullptr, not shared
  std::string who;                             ///< its peer in the report
  std::string kind;                            ///< what the report calls it
  std::uint32_t number = 0; ///< among the apps of its peer, if its lives are added up; 0: each for
                            ///< itself
  peer_id self;             ///< of its kernel
  peis_peer_actor peer;
  ecology_actor ecology;
  components::outside_component* outside = nullptr; ///< the core, if it has a thread of its own
};

struct component_state {
  component_arguments arguments;
  std::set<std::uint64_t> references; ///< numbers of watches that show where meta tuples point
  timer wake;
};

component_actor::behavior_type
component_behavior(scheduler::actor_pointer<component_state, component_actor> self,
                   component_arguments arguments);

} // namespace rubicon
