// Files of ecologies to begin with (share/templates), as they are in the binary.
#pragma once

#include <span>
#include <string_view>

namespace rubicon::cli {

struct ecology_template {
  std::string_view name; ///< `home`
  std::string_view text; ///< TOML; its first line is `# NAME: WHAT IT IS`
};

[[nodiscard]] std::span<const ecology_template> all_templates();

/// A file of a folder to begin with (share/templates/firmware and those beside it).
struct project_file {
  std::string_view name; ///< `flood.c`
  std::string_view text;
};

// In the order in which they are written.
[[nodiscard]] std::span<const project_file> firmware_project();
[[nodiscard]] std::span<const project_file> lua_project();
[[nodiscard]] std::span<const project_file> python_project();

/// What it is, from its first line.
[[nodiscard]] constexpr std::string_view sentence_of(const ecology_template& x) {
  const auto line = x.text.substr(0, x.text.find('\n'));
  return line.substr(line.find(": ") + 2);
}

} // namespace rubicon::cli
