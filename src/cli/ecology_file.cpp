#include "cli/ecology_file.hpp"

#include <cstdio>
#include <utility>

#include "cli/console.hpp"
#include "config/document.hpp"
#include "config/problem_text.hpp"
#include "core/hash.hpp"

namespace rubicon::cli {

std::optional<ecology_file> load_or_complain(const std::string& file,
                                             const config::overrides& instead,
                                             const config::extensions& known) {
  const bool is_input = file == standard_input;
  const std::string name = is_input ? "<stdin>" : file;
  const auto read = is_input ? config::read_stream(*stdin, config::file_octets_max)
                             : config::read_file(file, config::file_octets_max);
  if (!read.text) {
    static_cast<void>(
        print(stderr, config::text_of({config::problem{name, 0, 0, read.reason}}, name)));
    return std::nullopt;
  }
  auto loaded = config::load_with_files(*read.text, name, instead, known);
  std::string text;
  for (const auto& skipped : loaded.warnings)
    text += to_string(skipped) + " (left out)\n";
  text += config::text_of(loaded.problems, name);
  static_cast<void>(print(stderr, text)); // without standard error the exit status must do
  if (!loaded.problems.empty())
    return std::nullopt;
  return ecology_file{*std::move(loaded.ecology),
                      fold64().add(std::string_view(*read.text)).value()};
}

} // namespace rubicon::cli
