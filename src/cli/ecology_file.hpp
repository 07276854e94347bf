// A file that describes an ecology, or everything that is wrong with it.
#pragma once

#include <optional>
#include <string>

#include "config/ecology.hpp"
#include "config/load.hpp"

namespace rubicon::cli {

/// Prints every problem on standard error, one a line, and their count when there are several.
/// @returns nothing if there was a problem (GEN-06)
[[nodiscard]] std::optional<config::ecology_description>
load_or_complain(const std::string& file, const config::overrides& instead,
                 const config::extensions& known);

} // namespace rubicon::cli
