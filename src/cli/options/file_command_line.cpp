#include "cli/options/file_command_line.hpp"

#include <string>

#include <CLI/CLI.hpp>

#include "cli/options/add_option.hpp"

namespace rubicon::cli {

file_command_line::file_command_line(CLI::App& app)
    : check_app_(*app.add_subcommand("check", "Check a file without running it, and summarise it")),
      schema_app_(*app.add_subcommand(
          "schema", "Print the JSON Schema of these files, for editors and validators")) {
  add_check();
  add_schema();
}

void file_command_line::add_check() {
  add_file(check_app_, check_.file);
  check_app_.add_flag("--list", check_.list, "List motes, peers and tuple keys instead");
  check_app_.add_flag("--strict", check_.is_strict, "Treat warnings about the file as errors");
  add_overrides(check_app_, check_.instead);
}

void file_command_line::add_schema() {
  schema_app_.add_option("--tables", schema_.tables_of)->group(""); // of docs/configuration.md
}

std::optional<command> file_command_line::parsed() const {
  if (check_app_.parsed())
    return check_;
  if (schema_app_.parsed())
    return schema_;
  return std::nullopt;
}

} // namespace rubicon::cli
