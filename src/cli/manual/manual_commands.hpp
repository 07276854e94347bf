// `rubicon check --explain`, `rubicon completion` and `rubicon help --pages`
#pragma once

#include "cli/words/command_line.hpp"
#include "cli/words/exit_status.hpp"

namespace rubicon::cli {

/// Prints what a key means.
[[nodiscard]] exit_status perform(const explain_key_command& x);

/// Prints a script for a shell.
[[nodiscard]] exit_status perform(const completion_command& x);

/// Writes the pages of the manual into a folder that exists.
[[nodiscard]] exit_status perform(const pages_command& x);

} // namespace rubicon::cli
