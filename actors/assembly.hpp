// From the description of an ecology to its actors.
#pragma once

#include "actors/ecology.hpp"

namespace rubicon {

using ecology_pointer = scheduler::traced_pointer<ecology_state, root_actor>;

/// Spawns everything that the description in the ecology's state places here, in an order that
/// depends on the description alone.
void assemble(ecology_pointer self);

/// Spawns a mote, for the first time or again after a failure.
void spawn_mote(ecology_pointer self, supervised_mote& mote);

} // namespace rubicon
