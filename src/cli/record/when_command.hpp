// `rubicon explain --when RECORD VIOLATION`
#pragma once

#include "cli/words/command_line.hpp"
#include "cli/words/exit_status.hpp"
#include "explain/traces.hpp"

namespace rubicon::cli {

/// Repeats the run of a record, and runs with other random numbers from some time on, until it is
/// known since when the violation was bound to happen.
[[nodiscard]] exit_status explain_when(const explain_command& x, const explain::traces& all);

} // namespace rubicon::cli
