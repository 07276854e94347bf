// `rubicon compare A B`
#pragma once

#include "cli/words/command_line.hpp"
#include "cli/words/exit_status.hpp"

namespace rubicon::cli {

/// Prints what differs, the most important first.
[[nodiscard]] exit_status perform(const compare_command& x);

} // namespace rubicon::cli
