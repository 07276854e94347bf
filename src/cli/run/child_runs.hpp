// Runs of this binary, or another, as child processes, some at a time, each with a limit of real
// time.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <list>
#include <string>
#include <vector>

#include "cli/child_process.hpp"
#include "cli/own_binary.hpp"
#include "cli/signal_descriptor.hpp"
#include "core/time.hpp"

namespace rubicon::cli {

/// From its construction on, a signal to end is taken by wait(). Destroying it kills what runs.
class child_runs {
public:
  struct ended_run {
    std::uint64_t id; ///< as given to start()
    child_end how;
    duration real;        ///< that it took; the limit if it overran
    bool overran = false; ///< it was killed because its time was over
  };

  /// @param limit real time that a run may take
  explicit child_runs(duration limit) : limit_(limit) {}

  /// @param program its path
  void start(std::uint64_t id, const std::vector<std::string>& words,
             const std::string& program = own_binary);
  [[nodiscard]] std::size_t size() const { return runs_.size(); }

  /// Until something happened, a run has had its time, or so long.
  /// @returns those that have ended; none once it is interrupted
  [[nodiscard]] std::vector<ended_run> wait(duration longest);

  /// A signal to end came, here or to a run.
  [[nodiscard]] bool interrupted() const { return interrupted_; }
  void interrupt() { interrupted_ = true; }

  void kill_all() { runs_.clear(); }

private:
  using steady = std::chrono::steady_clock;

  struct run {
    std::uint64_t id;
    steady::time_point started;
    child_process child;
    bool overran = false;
  };

  [[nodiscard]] int patience_ms(duration longest) const;

  duration limit_;
  bool interrupted_ = false;
  signal_descriptor signals_;
  std::list<run> runs_; // ends before the signals are let through
};

} // namespace rubicon::cli
