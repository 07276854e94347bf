// `rubicon new TEMPLATE`
#pragma once

#include "cli/words/command_line.hpp"
#include "cli/words/exit_status.hpp"

namespace rubicon::cli {

/// Writes a file that runs, and says what to do with it; without a template lists them.
[[nodiscard]] exit_status perform(const new_command& x);

} // namespace rubicon::cli
