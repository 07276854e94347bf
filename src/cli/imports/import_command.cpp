#include "cli/imports/import_command.hpp"

#include <filesystem>
#include <string>
#include <system_error>
#include <utility>
#include <variant>

#include "cli/ecology_file.hpp"
#include "cli/print/console.hpp"
#include "cli/print/new_file.hpp"
#include "config/load.hpp"
#include "core/text/printable.hpp"
#include "core/text/shell_word.hpp"

namespace rubicon::cli {

namespace {

/// The imported file as the new one refers to it.
std::string seen_from(const std::string& to, const std::string& file) {
  const auto folder =
      to == standard_input ? std::filesystem::path(".") : std::filesystem::path(to).parent_path();
  std::error_code error;
  const auto out = std::filesystem::proximate(file, folder.empty() ? "." : folder, error);
  return error ? file : out.string();
}

std::string placed(const std::string& file, const imports::import_problem& x) {
  const auto where = x.at.line == 0
                         ? std::string()
                         : ':' + std::to_string(x.at.line) + ':' + std::to_string(x.at.column);
  return file + where + ": " + x.message;
}

} // namespace

exit_status perform(const import_command& x) {
  const auto read = config::read_file(x.file, imports::file_octets_max);
  if (!read.text)
    return refuse(x.file + ": " + read.reason);
  const auto& text = read.text;
  const auto from = x.format ? x.format : imports::format_of(x.file, *text);
  if (!from)
    return refuse(x.file + ": its format is not known: --format names it");
  const auto result = imports::import_text(*from, *text);
  if (const auto* why = std::get_if<imports::import_problem>(&result)) {
    say(placed(x.file, *why));
    return exit_status::refused;
  }
  const auto& found = std::get<imports::imported>(result);
  const auto to =
      x.to.empty() ? std::filesystem::path(x.file).replace_extension(".toml").string() : x.to;
  const auto toml = imports::toml_of(found, *from, x.file, seen_from(to, x.file));
  static_cast<void>(print(stderr, imports::notes_text(found, printable(x.file))));
  if (to == standard_input) // here: standard output
    return print(stdout, toml) ? exit_status::good : exit_status::refused;
  if (const auto why = write_new_file(to, toml, x.is_forced); !why.empty())
    return refuse(why);
  return print(stdout, "wrote " + to + "\nNext: rubicon run " + shell_word(to) + '\n')
             ? exit_status::good
             : exit_status::refused;
}

} // namespace rubicon::cli
