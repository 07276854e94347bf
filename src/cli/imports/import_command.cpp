#include "cli/imports/import_command.hpp"

#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <variant>

#include "cli/ecology_file.hpp"
#include "cli/print/console.hpp"
#include "cli/print/new_file.hpp"
#include "config/load.hpp"
#include "core/text/printable.hpp"
#include "core/text/shell_word.hpp"
#include "imports/gzip.hpp"

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

/// A file, decompressed.
struct source {
  std::string name; ///< without .gz
  std::string text;
  bool was_compressed = false;
};

/// @returns the file, or why there is none
std::variant<source, std::string> source_of(const std::string& file) {
  auto read = config::read_file(file, imports::file_octets_max);
  if (!read.text)
    return file + ": " + read.reason;
  if (!imports::is_gzip(*read.text))
    return source{file, *std::move(read.text)};
  auto content = imports::gunzip(*read.text);
  if (const auto* why = std::get_if<imports::import_problem>(&content))
    return placed(file, *why);
  constexpr std::string_view ending = ".gz";
  auto name = file.ends_with(ending) ? file.substr(0, file.size() - ending.size()) : file;
  return source{std::move(name), std::get<std::string>(std::move(content)), true};
}

/// @param to the file to write, or standard_input, here: standard output
exit_status write_toml(const std::string& to, const std::string& toml, bool is_forced) {
  if (toml.size() > config::file_octets_max)
    return refuse("the new file would have " + std::to_string(toml.size()) +
                  " octets, and a file has at most " + std::to_string(config::file_octets_max) +
                  ": import a part of it");
  if (to == standard_input)
    return print(stdout, toml) ? exit_status::good : exit_status::refused;
  if (const auto why = write_new_file(to, toml, is_forced); !why.empty())
    return refuse(why);
  return print(stdout, "wrote " + to + "\nNext: rubicon run " + shell_word(to) + '\n')
             ? exit_status::good
             : exit_status::refused;
}

} // namespace

exit_status perform(const import_command& x) {
  const auto read = source_of(x.file);
  if (const auto* why = std::get_if<std::string>(&read))
    return refuse(*why);
  const auto& file = std::get<source>(read);
  const auto from = x.format ? x.format : imports::format_of(file.name, file.text);
  if (!from)
    return refuse(x.file + ": its format is not known: --format names it");
  if (from == imports::format::tossim && file.was_compressed)
    return refuse(x.file + ": the new file would refer to it, and a run reads no compressed gains: "
                           "decompress it first (gunzip)");
  const auto result = imports::import_text(*from, file.text, x.sink);
  if (const auto* why = std::get_if<imports::import_problem>(&result)) {
    say(placed(x.file, *why));
    return exit_status::refused;
  }
  const auto& found = std::get<imports::imported>(result);
  const auto to =
      x.to.empty() ? std::filesystem::path(file.name).replace_extension(".toml").string() : x.to;
  static_cast<void>(print(stderr, imports::notes_text(found, printable(x.file))));
  return write_toml(to, imports::toml_of(found, *from, x.file, seen_from(to, x.file)), x.is_forced);
}

} // namespace rubicon::cli
