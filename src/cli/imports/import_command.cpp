#include "cli/imports/import_command.hpp"

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <variant>

#include "cli/ecology_file.hpp"
#include "cli/print/console.hpp"
#include "cli/print/new_file.hpp"
#include "core/text/printable.hpp"
#include "core/text/shell_word.hpp"

namespace rubicon::cli {

namespace {

/// The file's octets, one more than may be imported at most.
std::optional<std::string> octets_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string out(imports::file_octets_max + 1, '\0');
  file.read(out.data(), static_cast<std::streamsize>(out.size()));
  if (file.bad() || !file.is_open() || (file.gcount() == 0 && !file.eof()))
    return std::nullopt;
  out.resize(static_cast<std::size_t>(file.gcount()));
  return out;
}

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
  const auto text = octets_of(x.file);
  if (!text)
    return refuse(x.file + ": cannot be read");
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
