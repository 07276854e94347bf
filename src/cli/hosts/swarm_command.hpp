// `rubicon swarm FILE --seeds A..B`
#pragma once

#include "cli/words/command_line.hpp"
#include "cli/words/exit_status.hpp"

namespace rubicon::cli {

/// Runs the file in virtual time once per seed, each run in a process of its own (a crash or a run
/// without end costs that run only), and prints violations in the order of the seeds.
/// @throws std::system_error if no run can be started
[[nodiscard]] exit_status perform(const swarm_command& x);

} // namespace rubicon::cli
