// `rubicon schema`
#pragma once

#include "cli/command_line.hpp"
#include "cli/exit_status.hpp"

namespace rubicon::cli {

/// Prints what a file may say.
[[nodiscard]] exit_status perform(const schema_command& x);

} // namespace rubicon::cli
