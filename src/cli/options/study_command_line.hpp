// The words of the commands about studies.
#pragma once

#include <optional>

#include "cli/words/command_line.hpp"

namespace CLI {
class App;
}

namespace rubicon::cli {

/// Adds `sweep` and `query` to a command line.
class study_command_line {
public:
  explicit study_command_line(CLI::App& app);
  study_command_line(const study_command_line&) = delete;
  study_command_line& operator=(const study_command_line&) = delete;

  /// The command that was given, after parsing.
  [[nodiscard]] std::optional<command> parsed() const;

private:
  void add_sweep();
  void add_query();
  void check_combination() const;

  CLI::App& sweep_app_;
  CLI::App& query_app_;
  sweep_command sweep_;
  query_command query_;
};

} // namespace rubicon::cli
