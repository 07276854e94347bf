// The words of the commands about the command line itself.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/words/command_line.hpp"

namespace CLI {
class App;
}

namespace rubicon::cli {

/// Adds `completion` and `help` to a command line.
class help_command_line {
public:
  explicit help_command_line(CLI::App& app);
  help_command_line(const help_command_line&) = delete;
  help_command_line& operator=(const help_command_line&) = delete;

  /// The command that was given, after parsing; `help` of a command is parsed as its --help.
  [[nodiscard]] std::optional<command> parsed() const;

private:
  CLI::App& completion_app_;
  CLI::App& help_app_;
  completion_command completion_;
  pages_command pages_;
  std::vector<std::string> of_;
};

} // namespace rubicon::cli
