// `run --reload`: the file is read again when somebody says so.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "actors/run.hpp"
#include "config/load.hpp"
#include "config/reload.hpp"
#include "io/hangup_watch.hpp"

namespace rubicon::cli {

/// Reads the file of a run in wall time again on each SIGHUP. What the run can follow happens, all
/// else is told on standard error with its place and the reason (ACT-10).
class reloader {
public:
  /// @param toml what the run begins with
  reloader(const std::string& toml, std::string file, const config::overrides& instead,
           const config::extensions& known);

  /// @pre the run has been made, and ends before this
  void begin(const run_control& run);

private:
  void read();

  std::string file_;
  config::followed_file followed_;
  std::optional<run_control> run_;
  std::unique_ptr<io::hangup_watch> watch_;
};

} // namespace rubicon::cli
