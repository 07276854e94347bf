#include <filesystem>
#include <memory>
#include <utility>

#include "config/file_readers.hpp"
#include "config/island/application_readers.hpp"
#include "config/toml/values.hpp"
#include "script/program.hpp"
#include "script/script_keys.hpp"

namespace rubicon::config {

namespace {

/// Fills in the text of a script, and complains about it.
void read_script(table_reader& in, const std::string& file, script::program_config& out) {
  const auto& files = *in.shared().files;
  const auto path = (std::filesystem::path(files.toml).parent_path() / file).string();
  auto found = files.read(path, script::source_octets_max);
  if (!found.text) {
    in.problems().add(in.at("script"), in_quotes(path) + ' ' + found.reason);
    return;
  }
  out.script = {std::filesystem::path(file).filename().string(), *std::move(found.text)};
  if (auto wrong = script::check(out.script, out.most))
    in.problems().add(problem{path, wrong->line, 0, std::move(wrong->message)});
}

struct script_table {
  std::string file;
  std::size_t streams = 0;
  named_values<double> settings;
};

auto script_keys() {
  using x = script_table;
  return keys::of(keys::required(
      "script", &x::file, text{path_octets_max},
      {"[script](lua.md) in Lua, relative to the folder of the TOML file", "", "file"}));
}

auto setting_keys() {
  using x = script_table;
  return keys::of(keys::optional("streams", &x::streams, whole<std::size_t>{0, 32},
                                 "streams of each sort that it has open at most"),
                  keys::optional("settings", &x::settings, pairs_of<real>{},
                                 {"numbers for the script, which has them in its table `settings`",
                                  "none", "`{ on_at = 25.0 }`"}));
}

} // namespace

placed_program read_lua(table_reader& in) {
  script::program_config app;
  script_table x;
  in.all(x, script_keys());
  in.all(app.most);
  in.all(x, setting_keys());
  for (const auto& [name, value] : x.settings)
    app.values.emplace(name.value, value);
  if (in.shared().files != nullptr && in.sound())
    read_script(in, x.file, app);
  return {apps::custom_config{
              script::make_kind(std::make_shared<const script::program_config>(std::move(app)),
                                x.streams),
              {}},
          {}};
}

} // namespace rubicon::config
