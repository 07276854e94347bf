// Values that a command line sets in a file: `--set island.kitchen.id=3`.
#pragma once

#include <string>
#include <vector>

#include "config/toml/document.hpp"
#include "config/toml/problem.hpp"

namespace rubicon::config {

/// `PATH=VALUE` each. A part of the path is a key, the name of one of several tables, their number
/// counted from 1, or `*` for all that are there; a part with a dot stands between double quotes.
/// The value is TOML, or else a text. One part alone is a parameter, if the file has it.
using settings = std::vector<std::string>;

/// Writes them into a file, in their order. What is set has the place of its setting.
void apply(const settings& all, node& root, complaints& problems);

/// The same problems with the setting itself as their file, where they are of one.
[[nodiscard]] std::vector<problem> with_settings(std::vector<problem> problems,
                                                 const settings& all);

} // namespace rubicon::config
