// The words of the commands about studies.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "cli/words/command_line.hpp"
#include "core/time.hpp"

namespace CLI {
class App;
}

namespace rubicon::cli {

/// Adds `sweep`, `compare`, `shrink` and `query` to a command line.
class study_command_line {
public:
  explicit study_command_line(CLI::App& app);
  study_command_line(const study_command_line&) = delete;
  study_command_line& operator=(const study_command_line&) = delete;

  /// The command that was given, after parsing.
  [[nodiscard]] std::optional<command> parsed() const;

private:
  void add_sweep();
  void add_runs(CLI::App& app, std::optional<std::uint64_t>& jobs, std::string& length,
                duration& timeout);
  void add_compare();
  void add_shrink();
  void add_query();
  void check_combination();

  CLI::App& sweep_app_;
  CLI::App& compare_app_;
  CLI::App& shrink_app_;
  CLI::App& query_app_;
  sweep_command sweep_;
  compare_command compare_;
  shrink_command shrink_;
  query_command query_;
};

} // namespace rubicon::cli
