// A moment of a run, from its report so far: parts on other hosts send nothing else.
#pragma once

#include "report/history.hpp"
#include "report/report.hpp"

namespace rubicon::view {

[[nodiscard]] report::run_sample sample_of(const report::run_report& x);

} // namespace rubicon::view
