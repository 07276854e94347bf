// A report on standard output, and what it means for the exit status.
#pragma once

#include "cli/words/exit_status.hpp"
#include "report/report.hpp"

namespace rubicon::cli {

[[nodiscard]] exit_status status_of(const report::run_report& x);

/// @param full every row, as text
/// @returns its status; refused if it cannot be written
[[nodiscard]] exit_status print_report(const report::run_report& x, bool json, bool full = false);

} // namespace rubicon::cli
