// What a command writes of a run beside its report: tables over time, and a page to send.
#pragma once

#include <array>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "actors/run/run.hpp"
#include "cli/words/watch_options.hpp"
#include "config/plan/ecology.hpp"
#include "report/history.hpp"
#include "report/print/csv.hpp"
#include "report/report.hpp"

namespace rubicon::cli {

class run_watch {
public:
  /// Makes the files. @throws std::runtime_error if one cannot be made
  run_watch(watch_options options, const config::ecology_description& ecology);

  /// Subscribes to what it needs of the run. Outlives the run.
  void attach(run_options& options);

  /// Writes the page and what is left of the tables; what could not be written becomes a violation.
  /// @param repeats the command that repeats the run
  void finish(report::run_report& x, const std::string& repeats, const std::string& digest);

private:
  using kind = report::csv_tables::kind;

  void write(kind which, const std::string& rows);

  watch_options options_;
  duration length_; ///< of the run, unless options say another
  /// What of the description somebody needs, and no more: it may be large.
  std::optional<config::ecology_description> ecology_;
  std::optional<report::csv_tables> tables_;
  report::history seen_;
  std::array<std::ofstream, report::csv_tables::kinds> csv_;
  std::ofstream page_;
};

} // namespace rubicon::cli
