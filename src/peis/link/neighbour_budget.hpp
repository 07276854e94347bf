// What one neighbour may have us do: octets, packages and work, each at a rate and with a burst.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>

#include "core/time.hpp"

namespace rubicon::peis {

/// Work in units of about a microsecond on the machine of docs/benchmarks.md. What every package
/// costs is one unit; a class that does more for one (a push for each tuple that matches, a walk
/// over all hosts) adds what that takes.
using work_units = std::uint64_t;

/// Adds up what the calls of a core cost, for the owner to charge to the neighbour that caused it:
///
///   work_.add(matches.size());                        in the core
///   network_.charge(x.from, tuples_.take_work(), now);  in its owner, after each call
class work_meter {
public:
  void add(work_units x) { sum_ += x; }
  /// What was added since the last call.
  [[nodiscard]] work_units take() { return std::exchange(sum_, 0); }

private:
  work_units sum_ = 0;
};

/// Per neighbour. A link whose neighbour is over it is not read until it is within it again: what
/// it sends waits at its own side, and nothing is lost.
struct budget_config {
  std::uint64_t octets_per_second = 1'000'000'000;
  std::uint64_t packages_per_second = 500'000;
  std::uint64_t work_per_second = 500'000;
  duration burst = 500ms; ///< so much of each rate may come at once
  duration debt_max = 2s; ///< what was already done when it was charged makes wait no longer
};

/// A rate with a burst: the time at which all that was taken would have come at the rate.
class rate_limit {
public:
  rate_limit() = default;
  /// @pre per_second > 0
  rate_limit(std::uint64_t per_second, duration burst, duration debt_max)
      : per_second_(per_second), burst_(burst), debt_max_(debt_max) {}

  /// Takes it whether or not there is room: what was done cannot be undone.
  void take(std::uint64_t amount, instant now) {
    const auto most = now + burst_ + debt_max_;
    const auto cost = static_cast<double>(amount) / static_cast<double>(per_second_);
    const auto longest = std::chrono::duration<double>(burst_ + debt_max_).count();
    const auto length =
        cost >= longest ? burst_ + debt_max_ : duration(static_cast<std::int64_t>(cost * 1e9));
    used_until_ = std::min(std::max(used_until_, now) + length, most);
  }

  /// When there is room again; in the past if there is.
  [[nodiscard]] instant free_at() const { return used_until_ - burst_; }

private:
  std::uint64_t per_second_ = 1;
  duration burst_{};
  duration debt_max_{};
  instant used_until_ = instant::min() + 1h; ///< may be subtracted from
};

/// One neighbour's account.
class neighbour_budget {
public:
  neighbour_budget() = default;
  explicit neighbour_budget(const budget_config& x)
      : octets_(x.octets_per_second, x.burst, x.debt_max),
        packages_(x.packages_per_second, x.burst, x.debt_max),
        work_(x.work_per_second, x.burst, x.debt_max) {}

  /// A package has come; it costs its octets and one unit of work.
  void charge_package(std::uint64_t octets, instant now) {
    octets_.take(octets, now);
    packages_.take(1, now);
    charge_work(1, now);
  }

  /// What it took beyond that.
  void charge_work(work_units x, instant now) {
    work_.take(x, now);
    work_done_ += x;
  }

  /// May it have more done now?
  [[nodiscard]] bool is_within(instant now) const { return free_at() <= now; }

  /// When it may.
  [[nodiscard]] instant free_at() const {
    return std::max(std::max(octets_.free_at(), packages_.free_at()), work_.free_at());
  }

  /// All work ever charged.
  [[nodiscard]] work_units work_done() const { return work_done_; }

private:
  rate_limit octets_;
  rate_limit packages_;
  rate_limit work_;
  work_units work_done_ = 0;
};

} // namespace rubicon::peis
