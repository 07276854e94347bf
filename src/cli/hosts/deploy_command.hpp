// `rubicon deploy FILE`
#pragma once

#include "cli/words/command_line.hpp"
#include "cli/words/exit_status.hpp"

namespace rubicon::cli {

/// Runs the file on its hosts, or on processes of this computer in their place, and prints one
/// report of all.
/// @throws std::exception if there is no room for files or processes
[[nodiscard]] exit_status perform(const deploy_command& x);

} // namespace rubicon::cli
