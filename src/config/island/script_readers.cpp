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

} // namespace

placed_program read_lua(table_reader& in) {
  script::program_config app;
  std::string file;
  std::size_t streams = 0;
  in.required("script", text{path_octets_max}, file,
              {"[script](lua.md) in Lua, relative to the folder of the TOML file", "", "file"});
  in.all(app.most);
  in.optional("streams", whole<std::size_t>{0, 32}, streams,
              "streams of each sort that it has open at most");
  named_values<double> values;
  in.optional("settings", pairs_of<real>{}, values,
              {"numbers for the script, which has them in its table `settings`", "none",
               "`{ on_at = 25.0 }`"});
  for (const auto& [name, value] : values)
    app.values.emplace(name.value, value);
  if (in.shared().files != nullptr && in.sound())
    read_script(in, file, app);
  return {apps::custom_config{
              script::make_kind(std::make_shared<const script::program_config>(std::move(app)),
                                streams),
              {}},
          {}};
}

} // namespace rubicon::config
