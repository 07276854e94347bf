// Applies the fault plan: what happens to motes, sinks, their clocks, air and cables. Faults of
// peers are in actors/supervision/peer_supervision.hpp, changes that are planned as faults are in
// actors/supervision/changes.hpp.
#pragma once

#include <cstdint>

#include "actors/supervision/assembly.hpp"

namespace rubicon {

/// Schedules the next fault of the plan, which may be long.
void schedule_fault(ecology_pointer self);

/// Applies a fault, of the plan or on request; schedules the next one.
void apply(ecology_pointer self, const apply_fault& x);

/// Switches a second mote off. What it has counted is part of the report.
/// @param fault the one that has added it
void end_double(ecology_pointer self, std::uint32_t fault);

/// @returns whether it was a second mote that has ended
bool on_double_down(ecology_pointer self, const caf::down_msg& x);

/// The second mote that has sent the present message; nullptr: it is of no such mote.
[[nodiscard]] supervised_double* double_of_sender(ecology_pointer self);

} // namespace rubicon
