// `run --steer`: another program decides when time goes on, and what happens (docs/steering.md).
#pragma once

#include "cli/ecology_file.hpp"
#include "cli/words/command_line.hpp"
#include "cli/words/exit_status.hpp"

namespace rubicon::cli {

/// Requests come from the socket `x.steer`, which must be there, or from the lines of that file.
/// Prints the report when they request the end, or when the file is over.
[[nodiscard]] exit_status run_steered(const run_command& x, ecology_file file);

} // namespace rubicon::cli
