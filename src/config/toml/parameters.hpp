// [parameters] of a file: values that its texts name, as in `"${loss}"`.
#pragma once

#include <string_view>

#include "config/toml/document.hpp"
#include "config/toml/problem.hpp"

namespace rubicon::config {

inline constexpr std::string_view parameters_key = "parameters";

/// Puts the values of parameters where texts name them. A text that is `${NAME}` and nothing else
/// becomes the value; within a longer text it is written as the file would, without quotes; `$${`
/// is a plain `${`. The table itself is taken out; a file without it is left as it is.
void put_parameters(node& root, complaints& problems);

} // namespace rubicon::config
