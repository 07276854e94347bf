// `rubicon tuples`, `rubicon hosts`, `rubicon route` and `rubicon ping`
#pragma once

#include "cli/words/exit_status.hpp"
#include "cli/words/network_command.hpp"

namespace rubicon::cli {

/// Joins the network, does it, prints the result and leaves.
[[nodiscard]] exit_status perform(const network_command& x);

} // namespace rubicon::cli
