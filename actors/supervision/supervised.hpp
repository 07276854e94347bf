// What all of the root supervisor uses: look-ups of what it supervises, and notes in its report.
#pragma once

#include <string>

#include "actors/supervision/assembly.hpp"

namespace rubicon {

/// Adds to the event log of a run. @param who an actor's path
void note_event(ecology_pointer self, const std::string& who, std::string what);

/// Adds a violation to the report, or reports it separately if the report is already out.
void add_violation(ecology_pointer self, const char* invariant, std::string detail);

/// An actor has failed: a violation. @param path the actor's
void record_failure(ecology_pointer self, const std::string& path, const std::string& text);

/// A mote's battery is flat.
void on_flat(ecology_pointer self, supervised_mote& mote);

/// A mote of the description, which may be one of another island by now. @pre it is simulated
[[nodiscard]] supervised_mote& mote_now(ecology_pointer self, mote_address x);

/// The island's part of the report. @pre it has one
[[nodiscard]] report::island_report& island_of(ecology_pointer self, island_id id);

[[nodiscard]] bool has_several_gateways(ecology_pointer self, island_id id);

/// A sink in the event log: `kitchen/sink`.
[[nodiscard]] std::string event_source(const supervised_sink& x);

} // namespace rubicon
