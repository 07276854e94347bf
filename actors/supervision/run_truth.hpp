// What the supervisor knows of a run that its invariants compare the report with.
#pragma once

#include "actors/supervision/assembly.hpp"
#include "report/invariants.hpp"

namespace rubicon {

/// @pre all answers to collect_report have come
[[nodiscard]] report::run_truth truth_of(ecology_pointer self);

} // namespace rubicon
