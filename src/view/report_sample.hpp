// A moment of a run as its report so far tells it: of parts on other hosts nothing else is known.
#pragma once

#include "report/history.hpp"
#include "report/report.hpp"

namespace rubicon::view {

[[nodiscard]] report::run_sample sample_of(const report::run_report& x);

} // namespace rubicon::view
