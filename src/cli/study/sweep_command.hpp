// `rubicon sweep FILE`
#pragma once

#include "cli/words/command_line.hpp"
#include "cli/words/exit_status.hpp"

namespace rubicon::cli {

/// Makes the runs that the database lacks, and prints what all of them say.
[[nodiscard]] exit_status perform(const sweep_command& x);

} // namespace rubicon::cli
