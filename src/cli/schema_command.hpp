// `rubicon schema`
#pragma once

#include "cli/words/command_line.hpp"
#include "cli/words/exit_status.hpp"

namespace rubicon::cli {

/// Prints what a file may say.
[[nodiscard]] exit_status perform(const schema_command& x);

} // namespace rubicon::cli
