// `rubicon import FILE [TOML]`
#pragma once

#include "cli/words/command_line.hpp"
#include "cli/words/exit_status.hpp"

namespace rubicon::cli {

/// Writes a file of another simulator as an ecology, and prints what was not taken.
[[nodiscard]] exit_status perform(const import_command& x);

} // namespace rubicon::cli
