#include "cli/ecology_file.hpp"

#include <utility>

#include "cli/console.hpp"

namespace rubicon::cli {

std::optional<config::ecology_description> load_or_complain(const std::string& file,
                                                            const config::overrides& instead) {
  auto loaded = config::load_file(file, instead);
  if (loaded.problems.empty())
    return std::move(loaded.ecology);
  std::string text;
  for (const auto& problem : loaded.problems)
    text += to_string(problem) + '\n';
  if (loaded.problems.size() > 1)
    text += file + ": " + std::to_string(loaded.problems.size()) + " problems\n";
  static_cast<void>(print(stderr, text)); // without standard error the exit status must do
  return std::nullopt;
}

} // namespace rubicon::cli
