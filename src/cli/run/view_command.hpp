// `rubicon view RECORD`
#pragma once

#include "cli/words/command_line.hpp"
#include "cli/words/exit_status.hpp"

namespace rubicon::cli {

[[nodiscard]] exit_status perform(const view_command& x);

} // namespace rubicon::cli
