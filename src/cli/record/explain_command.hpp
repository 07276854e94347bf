// `rubicon explain RECORD [WHAT]`
#pragma once

#include "cli/words/command_line.hpp"
#include "cli/words/exit_status.hpp"

namespace rubicon::cli {

/// Prints the path of a message or of a tuple's value, or what there is to ask for.
[[nodiscard]] exit_status perform(const explain_command& x);

} // namespace rubicon::cli
