// `rubicon explain --when RECORD [VIOLATION]`
#pragma once

#include "cli/words/command_line.hpp"
#include "cli/words/exit_status.hpp"

namespace rubicon::cli {

/// Repeats the run of a record, and runs with other random numbers from some time on, until it is
/// known since when the violation was bound to happen.
[[nodiscard]] exit_status perform(const when_command& x);

} // namespace rubicon::cli
