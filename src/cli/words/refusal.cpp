#include "cli/words/refusal.hpp"

#include <algorithm>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/text/printable.hpp"
#include "core/text/spelling.hpp"

namespace rubicon::cli {

namespace {

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const auto* option : app.get_options())
    for (const auto& name : option->get_lnames())
      names.push_back("--" + name);
  return names;
}

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const auto* command : app.get_subcommands({}))
    names.push_back(command->get_name());
  return names;
}

/// The command that a refused line begins with, `tuples set `: its help is worth reading.
std::string command_meant(const CLI::App& app, std::span<const char* const> arguments) {
  std::string words;
  const auto* at = &app;
  for (const std::string word : arguments.subspan(1)) {
    const auto found = at->get_subcommands([&](const auto* x) { return x->get_name() == word; });
    if (found.empty())
      break;
    at = found.front();
    words += word + ' ';
  }
  return words;
}

} // namespace

std::string unknown_word(const CLI::App& app, std::span<const char* const> arguments) {
  const auto* at = &app;
  for (const std::string argument : arguments.subspan(1)) {
    const auto word = argument.substr(0, argument.find('='));
    const auto commands = command_names(*at);
    if (word.starts_with("--")) {
      const auto options = option_names(*at);
      if (std::ranges::find(options, word) == options.end())
        return "there is no option `" + word + '`' + suggestion(word, options);
    } else if (std::ranges::find(commands, word) != commands.end()) {
      at = at->get_subcommands([&](const auto* x) { return x->get_name() == word; }).front();
    } else if (!commands.empty() && !word.starts_with('-')) {
      return "there is no command `" + word + '`' + suggestion(word, commands);
    }
  }
  return {};
}

std::string refusal(const CLI::App& app, std::span<const char* const> arguments,
                    const std::string& why) {
  return "rubicon: " + printable(why) + "\nSee rubicon " + command_meant(app, arguments) +
         "--help.\n";
}

} // namespace rubicon::cli
