// The words of the commands that read records of runs.
#pragma once

#include <optional>

#include "cli/words/command_line.hpp"

namespace CLI {
class App;
}

namespace rubicon::cli {

/// Adds `explain` and `view` to a command line.
class record_command_line {
public:
  explicit record_command_line(CLI::App& app);
  record_command_line(const record_command_line&) = delete;
  record_command_line& operator=(const record_command_line&) = delete;

  /// The command that was given, after parsing.
  [[nodiscard]] std::optional<command> parsed() const;

private:
  void add_explain();
  void add_when();
  void add_view();
  void check_explain() const;

  CLI::App& explain_app_;
  CLI::App& view_app_;
  explain_command explain_;
  bool asks_when_ = false;
  when_command when_;
  view_command view_;
};

} // namespace rubicon::cli
