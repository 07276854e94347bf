// `rubicon query DATABASE SQL`
#pragma once

#include "cli/words/command_line.hpp"
#include "cli/words/exit_status.hpp"

namespace rubicon::cli {

/// Prints the rows.
[[nodiscard]] exit_status perform(const query_command& x);

} // namespace rubicon::cli
