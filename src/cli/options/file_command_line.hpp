// The words of the commands about a file, which run nothing.
#pragma once

#include <optional>

#include "cli/words/command_line.hpp"

namespace CLI {
class App;
}

namespace rubicon::cli {

/// Adds `new`, `check`, `import` and `schema` to a command line.
class file_command_line {
public:
  explicit file_command_line(CLI::App& app);
  file_command_line(const file_command_line&) = delete;
  file_command_line& operator=(const file_command_line&) = delete;

  /// The command that was given, after parsing.
  [[nodiscard]] std::optional<command> parsed() const;

private:
  void add_new();
  void add_check();
  void add_import();
  void add_schema();

  CLI::App& new_app_;
  CLI::App& check_app_;
  CLI::App& import_app_;
  CLI::App& schema_app_;
  new_command new_;
  check_command check_;
  explain_key_command explained_;
  import_command import_;
  schema_command schema_;
};

} // namespace rubicon::cli
