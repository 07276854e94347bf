// `rubicon view RECORD`
#pragma once

#include "cli/command_line.hpp"
#include "cli/exit_status.hpp"

namespace rubicon::cli {

[[nodiscard]] exit_status perform(const view_command& x);

} // namespace rubicon::cli
