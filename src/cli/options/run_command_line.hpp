// The words of `rubicon run`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/words/command_line.hpp"

namespace CLI {
class App;
class Option;
} // namespace CLI

namespace rubicon::cli {

/// Adds `run` to a command line.
class run_command_line {
public:
  explicit run_command_line(CLI::App& app);
  run_command_line(const run_command_line&) = delete;
  run_command_line& operator=(const run_command_line&) = delete;

  /// The command that was given, after parsing.
  /// @param original options that were taken out of the line
  [[nodiscard]] std::optional<run_command> parsed(const original_options& original) const;

private:
  // Each row says which it is: a run that is repeated has the options of the first kind again.

  /// An option that decides what runs.
  CLI::Option* decides(CLI::Option* option);
  /// An option that does not, or that whoever repeats a run sets anew.
  CLI::Option* shows(CLI::Option* option);

  void add_clock();
  void add_report();
  void add_page();
  void add_metrics();
  void add_logs();
  void add_records();
  void add_host();
  void add_part(CLI::Option& host);
  void add_checks();
  void check_combination() const;
  void check_steer() const;
  void check_determinism() const;
  [[nodiscard]] std::vector<std::string> repeated_options() const;

  CLI::App& app_;
  run_command run_;
  std::vector<const CLI::Option*> deciding_; ///< in the order of the help
  std::size_t rows_ = 0;
};

} // namespace rubicon::cli
