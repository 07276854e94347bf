// From a TOML file to the description of an ecology, or to all that is wrong with it (GEN-04,
// GEN-06).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "config/ecology.hpp"
#include "config/problem.hpp"

namespace rubicon::config {

struct loaded {
  std::optional<ecology_description> ecology; ///< only if there are no problems
  std::vector<problem> problems;              ///< in order of place
};

/// A syntax error hides everything else; all other problems are told together.
/// @param file_name how problems call the text
[[nodiscard]] loaded load_text(std::string_view toml, const std::string& file_name);

/// The same for a file. One that is missing, unreadable, a directory, binary or empty is one
/// problem.
[[nodiscard]] loaded load_file(const std::string& path);

/// Every key a file may have, with the table it belongs to as docs/configuration.md calls it;
/// sorted.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> accepted_keys();

} // namespace rubicon::config
