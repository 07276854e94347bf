// The backbone between an island's sink and a further one.
#pragma once

#include <array>

#include "actors/base/timer.hpp"
#include "actors/messages/backbone.hpp"
#include "actors/messages/supervision.hpp"
#include "core/address.hpp"
#include "serial/cable/backbone.hpp"

namespace rubicon {

/// Which backbone it is.
struct backbone_place {
  island_id island;
  mote_id sink;
  mote_id further;
};

struct backbone_state {
  serial::backbone link;
  backbone_place place;
  std::array<backbone_end_actor, 2> ends; ///< by serial::backbone_direction, empty until attached
  ecology_actor ecology;
  timer wake;
};

backbone_actor::behavior_type
backbone(scheduler::actor_pointer<backbone_state, backbone_actor> self, serial::backbone link,
         backbone_place place, ecology_actor ecology);

} // namespace rubicon
