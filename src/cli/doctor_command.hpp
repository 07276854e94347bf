// `rubicon doctor [FILE]`
#pragma once

#include "cli/words/command_line.hpp"
#include "cli/words/exit_status.hpp"

namespace rubicon::cli {

/// Looks at this computer, and at the hosts of a file, and says what to do about what is wrong.
/// @returns failed if anything is
[[nodiscard]] exit_status perform(const doctor_command& x);

} // namespace rubicon::cli
