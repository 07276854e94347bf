// `rubicon status`, `rubicon stop` and `rubicon fault`
#pragma once

#include "cli/words/command_line.hpp"
#include "cli/words/exit_status.hpp"

namespace rubicon::cli {

/// @returns failed if a host does not answer, refused if there is no deployment or a host refuses
[[nodiscard]] exit_status perform(const deployed_command& x);

} // namespace rubicon::cli
