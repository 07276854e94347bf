// A report on standard output, and what it means for the exit status.
#pragma once

#include "cli/words/exit_status.hpp"
#include "config/plan/labels.hpp"
#include "config/run/variation.hpp"
#include "report/report.hpp"

namespace rubicon::cli {

[[nodiscard]] exit_status status_of(const report::run_report& x);

/// How much of a report is printed, and as what.
struct report_form {
  bool json = false;
  bool full = false;  ///< every row, as text
  bool brief = false; ///< the verdict only, as text
};

/// @param labels of the file that was run
/// @param varied what its seed has decided of that file
/// @returns its status; refused if it cannot be written
[[nodiscard]] exit_status print_report(const report::run_report& x, const report_form& form,
                                       const config::label_table& labels,
                                       const config::variation& varied = {});

} // namespace rubicon::cli
