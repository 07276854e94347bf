// All that is wrong with a file, as people read it.
#pragma once

#include <string>
#include <vector>

#include "config/toml/problem.hpp"

namespace rubicon::config {

/// A line for each problem, 50 at most, and then their count; empty if there is none.
[[nodiscard]] std::string text_of(const std::vector<problem>& problems, const std::string& file);

} // namespace rubicon::config
