// `rubicon deploy FILE`
#pragma once

#include "cli/command_line.hpp"
#include "cli/exit_status.hpp"

namespace rubicon::cli {

/// Starts a process for each host of the file, starts it again if it is killed, and prints one
/// report of all.
/// @throws std::system_error if there is no room for files or processes
[[nodiscard]] exit_status perform(const deploy_command& x);

} // namespace rubicon::cli
