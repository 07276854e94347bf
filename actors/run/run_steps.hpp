// How far a run goes at once, and whether its process stood still meanwhile.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <optional>
#include <utility>

#include "actors/run/run.hpp"
#include "core/time.hpp"
#include "io/process/machine.hpp"
#include "scheduler/world.hpp"

namespace rubicon {

/// Runs in steps short enough for a progress bar: one or two a real second, however fast time
/// passes. They change nothing, but no round of the processes is longer than a step, and short
/// rounds fetch each island's motes into the cache for a few events.
class progress_steps {
public:
  /// @param speed ecology seconds a real second; 0: as fast as possible
  progress_steps(scheduler::world& world, instant end, const run_options& options, double speed)
      : world_(world), end_(end), options_(options),
        longest_(speed > 0 ? std::max(duration(static_cast<std::int64_t>(speed * 1e8)), shortest)
                           : end.time_since_epoch()) {}

  scheduler::stop_cause run_to(instant until) {
    if (!options_.progress)
      return world_.run_until(until);
    for (;;) {
      const auto started = std::chrono::steady_clock::now();
      const auto cause = world_.run_until(std::min(until, parallel::later(world_.now(), length_)));
      const auto took = std::chrono::steady_clock::now() - started;
      options_.progress({world_.now(), end_, world_.trace().events()});
      if (took > 1s)
        length_ = std::max(length_ / 2, shortest);
      if (cause != scheduler::stop_cause::reached_end || world_.now() >= until)
        return cause;
      if (took < 400ms)
        length_ = std::min(2 * length_, longest_);
    }
  }

private:
  static constexpr duration shortest = 1ms;

  scheduler::world& world_;
  instant end_; ///< of the run
  const run_options& options_;
  duration longest_;
  duration length_ = shortest; ///< lasts over all calls: a run ahead stops at each
};

/// Notices that a run in wall time has stood still: its process was stopped, or its computer was
/// suspended. Processes that waited for it meanwhile have given it up.
class standstill {
public:
  /// @param speed ecology seconds a real second
  explicit standstill(double speed) : speed_(speed) {}

  static constexpr duration look_every = 1s; ///< of ecology time, at speed 1

  /// @returns how long, once; nothing if it went on
  [[nodiscard]] std::optional<duration> look(instant now) {
    constexpr duration shortest = 5s; // others wait longer
    const std::chrono::microseconds real(io::time_since_boot_us());
    const auto passed = real - std::exchange(last_real_, real);
    const auto planned = duration(static_cast<duration::rep>(
        static_cast<double>((now - std::exchange(last_, now)).count()) / speed_));
    const auto still = passed - planned;
    if (!std::exchange(has_looked_, true) || still < shortest)
      return std::nullopt;
    return still;
  }

private:
  double speed_;
  bool has_looked_ = false;
  std::chrono::microseconds last_real_{};
  instant last_;
};

} // namespace rubicon
