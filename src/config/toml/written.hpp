// A parsed file as text again.
#pragma once

#include <string>

#include "config/toml/document.hpp"

namespace rubicon::config {

/// TOML that parse() makes the same of, but for places and the order of keys in a table: tables
/// follow plain values. @pre `root` is a table, and holds no date or time
[[nodiscard]] std::string written(const node& root);

} // namespace rubicon::config
