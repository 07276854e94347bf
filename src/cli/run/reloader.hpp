// `run --reload`: the file is read again on SIGHUP.
#pragma once

#include <optional>
#include <string>

#include "actors/run/run.hpp"
#include "config/load.hpp"
#include "config/run/reload.hpp"

namespace rubicon::cli {

/// Reads the file of a run in wall time again. What the run can apply is applied, all
/// else is reported on standard error with its place and the reason (ACT-10).
class reloader {
public:
  /// @param toml what the run begins with
  reloader(const std::string& toml, std::string file, const config::overrides& instead,
           const config::extensions& known);

  /// Of the run that read() is about.
  void begin(const run_control& run) { run_.emplace(run); }

  /// @pre the run has begun and not ended
  void read();

private:
  std::string file_;
  config::followed_file followed_;
  std::optional<run_control> run_;
};

} // namespace rubicon::cli
