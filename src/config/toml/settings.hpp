// Values that a command line sets in a file, `--set island.kitchen.id=3`, and [parameters] of a
// file, which its texts name as in `"${loss}"`.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
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

inline constexpr std::string_view parameters_key = "parameters";

/// Names, and values as a setting has them: `outage`, `12.3s`.
using parameter_values = std::map<std::string, std::string>;

/// Puts the values of parameters where texts name them. A text that is `${NAME}` and nothing else
/// becomes the value; within a longer text it is written as the file would, without quotes; `$${`
/// is a plain `${`. The table itself is taken out; a file without it is left as it is.
/// @param seed of the run, which decides those that have a range
/// @returns what these are
parameter_values put_parameters(node& root, std::uint64_t seed, complaints& problems);

} // namespace rubicon::config
