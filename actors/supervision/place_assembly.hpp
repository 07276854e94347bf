// The part of the assembly that makes a place: its air, and all that is in it.
#pragma once

#include "actors/supervision/assembly.hpp"
#include "config/plan/ecology.hpp"

namespace rubicon {

/// The air of one place, and the bridges and motes of its islands.
void spawn_place(ecology_pointer self, const config::air_description& air);

} // namespace rubicon
