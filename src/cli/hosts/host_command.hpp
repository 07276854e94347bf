// `rubicon host`: this computer as one of those that run an ecology together.
#pragma once

#include "cli/words/command_line.hpp"
#include "cli/words/exit_status.hpp"

namespace rubicon::cli {

/// Runs until a signal ends it.
[[nodiscard]] exit_status perform(const host_command& x);

} // namespace rubicon::cli
