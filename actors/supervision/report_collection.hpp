// Puts the report together from what actors answer: samples while the run lasts, everything at its
// end.
#pragma once

#include "actors/messages/programs.hpp"
#include "actors/supervision/assembly.hpp"

namespace rubicon {

/// The islands and gateways of the description.
void prepare_report(ecology_pointer self);

/// Asks whoever can answer for a sample, at the times that expectations need.
void schedule_sample(ecology_pointer self);
void on_take_sample(ecology_pointer self);
void on_sample(ecology_pointer self, const sample_status& x);

/// Adds what the supervisor itself knows of its motes, and requests the rest.
void begin_collecting(ecology_pointer self);
void on_network(ecology_pointer self, const network_status& x);
void on_energy(ecology_pointer self, const energy_status& x);
void on_program(ecology_pointer self, const program_status& x);
void on_lead(ecology_pointer self, const gateway_status& x);

/// Completes the report, checks its invariants and hands it out.
void deliver(ecology_pointer self);

} // namespace rubicon
