// `rubicon run FILE`
#pragma once

#include "cli/words/command_line.hpp"
#include "cli/words/exit_status.hpp"

namespace rubicon::cli {

/// Runs the file and prints the report, or runs it twice and prints both trace hashes.
/// @throws std::exception if the run cannot be done (see run_ecology)
[[nodiscard]] exit_status perform(const run_command& x);

} // namespace rubicon::cli
