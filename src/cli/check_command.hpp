// `rubicon check FILE`
#pragma once

#include "cli/words/command_line.hpp"
#include "cli/words/exit_status.hpp"

namespace rubicon::cli {

/// Prints a summary of a good file, or a list of what it has, or how it differs from another; and
/// on standard error what in it cannot work.
[[nodiscard]] exit_status perform(const check_command& x);

} // namespace rubicon::cli
