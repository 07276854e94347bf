// Runs as child processes whose results a study takes, with their progress on a terminal.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cli/own_binary.hpp"
#include "cli/print/console.hpp"
#include "cli/run/child_runs.hpp"
#include "cli/words/exit_status.hpp"
#include "core/time.hpp"
#include "study/store.hpp"

namespace rubicon::cli {

/// A run that a study needs.
struct result_job {
  std::string label; ///< `loss=0.1, seed 7`: what it is called when it has no result
  std::uint64_t seed = 0;
  std::vector<std::string> words;
  std::string program = own_binary;
};

/// Which runs a study needs, and what it does with their results.
class result_plan {
public:
  virtual ~result_plan() = default;

  /// Nothing if there is none, or none before another has ended.
  [[nodiscard]] virtual std::optional<result_job> next() = 0;

  /// The result of the run that next() gave as the n-th, from 0; unset if it has none. Its key,
  /// file and parameters are not set.
  virtual void take(std::size_t n, std::optional<study::run_result> x) = 0;

  /// How many next() gives, as far as is known.
  [[nodiscard]] virtual std::size_t expected() const = 0;
};

class result_runs {
public:
  /// @param jobs runs at a time; unset: one a core
  result_runs(std::optional<std::uint64_t> jobs, duration timeout);

  /// Says of each run without a result why. @returns failed if there was one, or interrupted
  [[nodiscard]] exit_status run_all(result_plan& plan);

private:
  using steady = std::chrono::steady_clock;

  void start_some(result_plan& plan);
  void collect(result_plan& plan, const child_runs::ended_run& x);
  void draw_progress(const result_plan& plan);
  void erase_progress();

  const std::uint64_t jobs_;
  const console errors_ = console_of(stderr);
  const steady::time_point started_ = steady::now();
  std::optional<duration> drawn_at_;
  std::size_t next_ = 0;
  std::size_t ended_ = 0;
  bool failed_ = false;
  std::map<std::uint64_t, result_job> jobs_in_progress_;
  child_runs runs_;
};

/// `84 of 200 runs  42%  7.0 runs/s  17 s left`, at most `width` characters.
[[nodiscard]] std::string study_progress(std::size_t ended, std::size_t expected, duration real,
                                         std::size_t width);

} // namespace rubicon::cli
