#include "cli/manual/new_command.hpp"

#include <algorithm>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "cli/ecology_file.hpp"
#include "cli/manual/templates.hpp"
#include "cli/own_binary.hpp"
#include "cli/print/console.hpp"
#include "cli/print/new_file.hpp"
#include "core/text/shell_word.hpp"
#include "core/text/spelling.hpp"

namespace rubicon::cli {

namespace {

struct program_option {
  std::string_view option;
  std::string_view what;
};
constexpr std::size_t longest_option = 14;
constexpr program_option program_options[] = {
    {"lua DIR", "a mote that switches a fan and reports its temperature, in Lua"},
    {"firmware DIR", "motes that flood a reading over five hops, in C"},
    {"python DIR", "a study of many runs, in Python"},
};

std::string list_of_templates() {
  std::size_t longest = 0;
  for (const auto& each : all_templates())
    longest = std::max(longest, each.name.size());
  std::string out = "Templates:\n";
  for (const auto& each : all_templates()) {
    const auto gap = std::string(longest + 2 - each.name.size(), ' ');
    out.append("  ").append(each.name).append(gap).append(sentence_of(each)).append("\n");
  }
  out += "\nrubicon new " + std::string(all_templates().front().name) +
         " writes the first one into a file.\n\nPrograms, each with an ecology, in a new folder:\n";
  for (const auto& [option, what] : program_options)
    out.append("  --")
        .append(option)
        .append(longest_option - option.size(), ' ')
        .append(what)
        .append("\n");
  return out;
}

const ecology_template* find_template(const std::string& name) {
  const auto found = std::ranges::find(all_templates(), name, &ecology_template::name);
  return found == all_templates().end() ? nullptr : &*found;
}

std::vector<std::string> template_names() {
  std::vector<std::string> out;
  for (const auto& each : all_templates())
    out.emplace_back(each.name);
  return out;
}

/// Names as a sentence has them: `a, b and c`.
std::string list_of_names(std::span<const project_file> files) {
  std::string out;
  for (std::size_t i = 0; i < files.size(); ++i) {
    out += i == 0 ? "" : i + 1 == files.size() ? " and " : ", ";
    out += files[i].name;
  }
  return out;
}

/// All that a program needs, in a folder. @param next what a user calls then
exit_status write_project(const std::string& name, std::span<const project_file> files,
                          bool replaces, const std::string& next) {
  const std::filesystem::path folder = name;
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error)
    return refuse(name + ": " + error.message());
  for (const auto& each : files)
    if (const auto why = write_new_file((folder / each.name).string(), each.text, replaces);
        !why.empty())
      return refuse(why);
  return print(stdout, "wrote " + list_of_names(files) + " in " + name + "\nNext: " + next + '\n')
             ? exit_status::good
             : exit_status::refused;
}

/// `python3 mine/window.py`, with where Python finds the package and the package this binary,
/// unless both are where they are looked for.
std::string python_run_of(const std::string& folder) {
  namespace fs = std::filesystem;
  const auto script = "python3 " + shell_word((fs::path(folder) / "window.py").string());
  std::error_code error;
  const auto binary = fs::read_symlink(own_binary, error);
  const auto beside = binary.parent_path();
  const auto installed = beside.parent_path() / "lib/python3/dist-packages";
  const auto in_tree = beside.parent_path().parent_path() / "python"; // of build/PRESET/rubicon
  const auto has_package = [&error](const fs::path& x) { return fs::exists(x / "rubicon", error); };
  if (has_package(installed))
    return beside == "/usr/bin" ? script
                                : "PYTHONPATH=" + shell_word(installed.string()) + ' ' + script;
  if (!has_package(in_tree))
    return script;
  return "PYTHONPATH=" + shell_word(in_tree.string()) + " RUBICON=" + shell_word(binary.string()) +
         ' ' + script;
}

/// @param toml the file of the ecology in that folder
std::string run_of(const std::string& folder, const char* toml) {
  return "rubicon run " + shell_word((std::filesystem::path(folder) / toml).string());
}

} // namespace

exit_status perform(const new_command& x) {
  if (!x.firmware.empty())
    return write_project(x.firmware, firmware_project(), x.is_forced,
                         "make -C " + shell_word(x.firmware) + " && " +
                             run_of(x.firmware, "flood.toml"));
  if (!x.lua.empty())
    return write_project(x.lua, lua_project(), x.is_forced, run_of(x.lua, "fan.toml"));
  if (!x.python.empty())
    return write_project(x.python, python_project(), x.is_forced, python_run_of(x.python));
  if (x.name.empty())
    return print(stdout, list_of_templates()) ? exit_status::good : exit_status::refused;
  const auto* const found = find_template(x.name);
  if (found == nullptr && std::ranges::any_of(program_options, [&x](const auto& each) {
        return each.option.substr(0, each.option.find(' ')) == x.name;
      }))
    return refuse('`' + x.name + "` is an option with a folder: rubicon new --" + x.name + " DIR");
  if (found == nullptr)
    return refuse("there is no template `" + x.name + '`' + suggestion(x.name, template_names()));
  if (x.file == standard_input) // here: standard output
    return print(stdout, found->text) ? exit_status::good : exit_status::refused;
  const auto path = x.file.empty() ? x.name + ".toml" : x.file;
  if (const auto why = write_new_file(path, found->text, x.is_forced); !why.empty())
    return refuse(why);
  return print(stdout, "wrote " + path + "\nNext: rubicon run " + shell_word(path) + '\n')
             ? exit_status::good
             : exit_status::refused;
}

} // namespace rubicon::cli
