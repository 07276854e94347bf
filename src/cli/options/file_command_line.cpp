#include "cli/options/file_command_line.hpp"

#include <string>

#include <CLI/CLI.hpp>

#include "cli/ecology_file.hpp"
#include "cli/options/add_option.hpp"

namespace rubicon::cli {

file_command_line::file_command_line(CLI::App& app)
    : new_app_(*app.add_subcommand("new", "Write a file to begin with, from a template")),
      check_app_(*app.add_subcommand("check", "Check a file without running it, and summarise it")),
      import_app_(*app.add_subcommand(
          "import", "Make a file of one of another simulator, or of measured links")),
      schema_app_(*app.add_subcommand(
          "schema", "Print the JSON Schema of these files, for editors and validators")) {
  add_new();
  add_check();
  add_import();
  add_schema();
}

void file_command_line::add_new() {
  auto* const name =
      new_app_.add_option("TEMPLATE", new_.name, "Its name; default: the templates are listed")
          ->type_name("");
  new_app_
      .add_option("FILE", new_.file,
                  "The file to write; - is standard output; default: TEMPLATE.toml")
      ->type_name("");
  new_app_.add_flag("--force", new_.is_forced, "Overwrite a file that exists");
  auto* const firmware =
      new_app_
          .add_option(
              "--firmware", new_.firmware,
              "Write firmware of motes in C instead, and an ecology for it, into this folder")
          ->type_name("DIR")
          ->excludes(name);
  auto* const lua =
      new_app_
          .add_option("--lua", new_.lua,
                      "Write a program in Lua instead, and an ecology for it, into this folder")
          ->type_name("DIR")
          ->excludes(name)
          ->excludes(firmware);
  new_app_
      .add_option("--python", new_.python,
                  "Write a study in Python instead, and an ecology for it, into this folder")
      ->type_name("DIR")
      ->excludes(name)
      ->excludes(firmware)
      ->excludes(lua);
}

void file_command_line::add_check() {
  auto* const file = add_file(check_app_, check_.file)->required(false);
  add_parsed(
      check_app_, "--explain", "KEY",
      "Explain a key, such as island.duty_cycle.period, duty_cycle or island.*.jitter, instead "
      "of checking a file",
      [this](const auto& text) { explained_.key = text; })
      ->excludes(file);
  check_app_.final_callback([this] {
    if (check_.file.empty() && explained_.key.empty())
      throw CLI::RequiredError("FILE");
    if (check_.file == standard_input && check_.changes_from == standard_input)
      throw CLI::ValidationError("--changes-from", "standard input is FILE already");
  });
  add_path(check_app_, "--changes-from", "OLD", check_.changes_from,
           "Show instead what a run of OLD applies and refuses if it reads FILE with run --reload");
  check_app_.add_flag("--list", check_.list, "List motes, peers and tuple keys instead");
  check_app_.add_flag("--strict", check_.is_strict, "Treat warnings about the file as errors");
  add_overrides(check_app_, check_.instead);
}

void file_command_line::add_import() {
  import_app_
      .add_option(
          "FILE", import_.file,
          "Cooja's .csc, movements of setdest, YAML of OTNS, JSON of IoT-LAB, gains of "
          "TOSSIM, a topology of RIOT's ZEP dispatcher, or a K7 trace; may be compressed (gzip)")
      ->required()
      ->type_name("");
  import_app_
      .add_option("TOML", import_.to,
                  "The file to write; - is standard output; default: FILE's name with .toml")
      ->type_name("");
  add_parsed(import_app_, "--format", "FORMAT",
             "cooja, setdest, otns, iotlab, tossim, zep or k7; default: by name and content",
             [this](const auto& text) {
               import_.format = imports::parse_format(text);
               if (!import_.format)
                 throw CLI::ValidationError("--format", "there is no format '" + text + "'");
             });
  import_app_
      .add_option("--sink", import_.sink,
                  "Mote of FILE that is the sink: its name, or its number if it has none; default: "
                  "the first one that does not move")
      ->type_name("MOTE");
  import_app_.add_flag("--force", import_.is_forced, "Overwrite a file that exists");
  import_app_.footer("It prints what it has not taken, a line each.");
}

void file_command_line::add_schema() {
  schema_app_.add_option("--tables", schema_.tables_of)->group(""); // of docs/configuration.md
}

std::optional<command> file_command_line::parsed() const {
  if (new_app_.parsed())
    return new_;
  if (check_app_.parsed() && !explained_.key.empty())
    return explained_;
  if (check_app_.parsed())
    return check_;
  if (import_app_.parsed())
    return import_;
  if (schema_app_.parsed())
    return schema_;
  return std::nullopt;
}

} // namespace rubicon::cli
