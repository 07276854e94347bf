#include "cli/ecology_file.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <utility>

#include "cli/console.hpp"
#include "config/document.hpp"
#include "core/hash.hpp"
#include "core/printable.hpp"

namespace rubicon::cli {

namespace {

/// The problems as people read them.
std::string told(const std::vector<config::problem>& problems, const std::string& file) {
  constexpr std::size_t told_max = 50;
  std::string text;
  for (std::size_t i = 0; i < std::min(problems.size(), told_max); ++i)
    text += to_string(problems[i]) + '\n';
  if (problems.size() > 1)
    text += printable(file) + ": " + std::to_string(problems.size()) + " problems";
  if (problems.size() > told_max)
    text += ", of which the first " + std::to_string(told_max) + " are above";
  return problems.size() > 1 ? text + '\n' : text;
}

} // namespace

std::optional<ecology_file> load_or_complain(const std::string& file,
                                             const config::overrides& instead,
                                             const config::extensions& known) {
  const bool is_input = file == standard_input;
  const std::string name = is_input ? "<stdin>" : file;
  const auto read = is_input ? config::read_stream(*stdin, config::file_octets_max)
                             : config::read_file(file, config::file_octets_max);
  if (!read.text) {
    static_cast<void>(print(stderr, told({config::problem{name, 0, 0, read.reason}}, name)));
    return std::nullopt;
  }
  auto loaded = config::load_with_files(*read.text, name, instead, known);
  std::string text;
  for (const auto& skipped : loaded.warnings)
    text += to_string(skipped) + " (left out)\n";
  text += told(loaded.problems, name);
  static_cast<void>(print(stderr, text)); // without standard error the exit status must do
  if (!loaded.problems.empty())
    return std::nullopt;
  return ecology_file{*std::move(loaded.ecology),
                      fold64().add(std::string_view(*read.text)).value()};
}

} // namespace rubicon::cli
