#include "cli/ecology_file.hpp"

#include <cstdio>
#include <utility>

#include "cli/print/console.hpp"
#include "cli/run/bundle_file.hpp"
#include "config/checks/warnings.hpp"
#include "config/toml/document.hpp"
#include "config/toml/problem_text.hpp"
#include "core/hash.hpp"
#include "core/text/printable.hpp"
#include "deploy/bundle.hpp"

namespace rubicon::cli {

namespace {

/// @pre it is loaded
std::uint64_t seed_of(const config::loaded& x, const config::overrides& instead) {
  return instead.seed.value_or(x.ecology->seed);
}

std::optional<ecology_file> load_bundle(const std::string& file, const config::overrides& instead,
                                        const config::extensions& known) {
  const auto bundle = read_bundle(file);
  if (!bundle) {
    static_cast<void>(print(stderr, printable(file) + " was not written by a host\n"));
    return std::nullopt;
  }
  auto loaded = deploy::load(*bundle, instead, known);
  complain(loaded, bundle->name);
  if (!loaded.problems.empty())
    return std::nullopt;
  auto warnings = config::warnings_of(loaded, bundle->name);
  auto varied = config::variation_of(bundle->toml, instead.settings, seed_of(loaded, instead));
  return ecology_file{*std::move(loaded.ecology),
                      fold64().add(std::string_view(bundle->toml)).value(), std::move(warnings),
                      bundle->toml, std::move(varied)};
}

} // namespace

std::string name_of_file(const std::string& file) {
  return file == standard_input ? "<stdin>" : file;
}

void complain(const config::loaded& x, const std::string& name) {
  std::string text;
  for (const auto& skipped : x.skipped)
    text += to_string(skipped) + " (left out)\n";
  text += config::text_of(x.problems, name);
  static_cast<void>(print(stderr, text)); // without standard error the exit status must do
}

void warn(const ecology_file& x) {
  std::string text;
  for (auto each : x.warnings) {
    each.message.insert(0, "warning: ");
    text += to_string(each) + '\n';
  }
  static_cast<void>(print(stderr, text)); // nobody reads it, nobody misses it
}

std::optional<ecology_file> load_or_complain(const std::string& file,
                                             const config::overrides& instead,
                                             const config::extensions& known, bool is_bundled) {
  if (is_bundled)
    return load_bundle(file, instead, known);
  const auto name = name_of_file(file);
  auto read = file == standard_input ? config::read_stream(*stdin, config::file_octets_max)
                                     : config::read_file(file, config::file_octets_max);
  if (!read.text) {
    complain({std::nullopt, {config::problem{name, 0, 0, read.reason}}}, name);
    return std::nullopt;
  }
  auto loaded = config::load_with_files(*read.text, name, instead, known);
  complain(loaded, name);
  if (!loaded.problems.empty())
    return std::nullopt;
  auto warnings = config::warnings_of(loaded, name);
  const auto text = config::resolved_text(*read.text, instead.settings);
  auto varied = config::variation_of(*read.text, instead.settings, seed_of(loaded, instead));
  return ecology_file{*std::move(loaded.ecology), fold64().add(std::string_view(text)).value(),
                      std::move(warnings), *std::move(read.text), std::move(varied)};
}

} // namespace rubicon::cli
