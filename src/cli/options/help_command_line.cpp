#include "cli/options/help_command_line.hpp"

#include <CLI/CLI.hpp>

#include "cli/options/add_option.hpp"

namespace rubicon::cli {

help_command_line::help_command_line(CLI::App& app)
    : completion_app_(
          *app.add_subcommand("completion", "Print the completion of these commands for a shell")),
      help_app_(*app.add_subcommand("help", "Show the help of a command")) {
  completion_app_.add_option("SHELL", completion_.shell, "The shell")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh", "fish"}))
      ->type_name("");
  completion_app_.footer(
      "In a running shell: eval \"$(rubicon completion bash)\". Packages install it.");
  help_app_.add_option("COMMAND", of_, "Its words, as in tuples set; default: this overview")
      ->type_name("");
  // For packages: all pages of the manual, dated.
  add_path(help_app_, "--pages", "DIR", pages_.folder, "Write the pages of the manual")->group("");
  help_app_.add_option("--date", pages_.date, "Date of the pages, YYYY-MM-DD")
      ->check([](const std::string& text) {
        const bool is_good = text.find_first_not_of("0123456789-") == std::string::npos;
        return is_good ? std::string() : "not a date: '" + text + '\'';
      })
      ->group("");
}

std::optional<command> help_command_line::parsed() const {
  if (completion_app_.parsed())
    return completion_;
  if (help_app_.parsed())
    return pages_;
  return std::nullopt;
}

} // namespace rubicon::cli
