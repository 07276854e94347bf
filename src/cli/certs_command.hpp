// `rubicon certs`
#pragma once

#include "cli/words/command_line.hpp"
#include "cli/words/exit_status.hpp"

namespace rubicon::cli {

/// Makes an authority or a certificate, or lists what is there. Status 1: one of those that are
/// there is no good.
[[nodiscard]] exit_status perform(const certs_command& x);

} // namespace rubicon::cli
