// `run --view`: a page shows the run, and stays afterwards.
#pragma once

#include <optional>
#include <string>

#include "actors/run/run.hpp"
#include "cli/run/live_page.hpp"
#include "cli/words/command_line.hpp"
#include "config/plan/ecology.hpp"
#include "io/files/temporary_folder.hpp"
#include "report/report.hpp"

namespace rubicon::cli {

/// The page of one run: what it shows, and what may be done to the run by hand.
class viewed_run {
public:
  /// @param command that repeats the run; empty: none does
  /// @pre x.watch.view
  viewed_run(const run_command& x, const config::ecology_description& ecology,
             const std::string& command);

  /// Has the page follow the run. @pre this outlives it
  void attach(run_options& options, const config::ecology_description& ecology);

  /// Stays until it is interrupted. @pre the report is printed
  void finish(const report::run_report& report);

private:
  /// A record for the page alone, gone from the disk as soon as the page reads it.
  class own_record {
  public:
    /// Makes the run write it; nothing: there is no room for temporary files.
    void attach(run_options& options);
    void read_by(live_page& page);

  private:
    std::optional<io::temporary_folder> folder_;
  };

  std::string record_;
  std::optional<manual_control> manual_;
  bool keeps_own_;
  own_record own_;
  live_page page_; ///< before its actions: its sessions use them
  manual_control::performer performer_;
};

} // namespace rubicon::cli
