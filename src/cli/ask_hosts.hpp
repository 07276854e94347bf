// One question to several hosts at the same time.
#pragma once

#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "cli/deployed.hpp"
#include "control/system.hpp"
#include "deploy/messages.hpp"

namespace rubicon::cli {

/// Waits for all of them.
/// @returns the answer of each host, in their order, or why there is none
[[nodiscard]] std::vector<std::variant<deploy::answer, std::string>>
ask_hosts(control::system& actors, const std::vector<deployed_host>& hosts,
          const std::function<deploy::question(const deployed_host&)>& what);

} // namespace rubicon::cli
