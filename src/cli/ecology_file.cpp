#include "cli/ecology_file.hpp"

#include <utility>

#include "cli/console.hpp"
#include "core/printable.hpp"

namespace rubicon::cli {

std::optional<config::ecology_description> load_or_complain(const std::string& file,
                                                            const config::overrides& instead,
                                                            const config::extensions& known) {
  auto loaded = config::load_file(file, instead, known);
  std::string text;
  for (const auto& skipped : loaded.warnings)
    text += to_string(skipped) + " (left out)\n";
  if (loaded.problems.empty()) {
    static_cast<void>(print(stderr, text)); // nobody reads it, nobody misses it
    return std::move(loaded.ecology);
  }
  for (const auto& problem : loaded.problems)
    text += to_string(problem) + '\n';
  if (loaded.problems.size() > 1)
    text += printable(file) + ": " + std::to_string(loaded.problems.size()) + " problems\n";
  static_cast<void>(print(stderr, text)); // without standard error the exit status must do
  return std::nullopt;
}

} // namespace rubicon::cli
