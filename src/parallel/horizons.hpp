// How far logical processes may run ahead of each other: conservative parallel simulation, without
// rollback (Chandy and Misra 1979; Fujimoto, Parallel and Distributed Simulation Systems, 2000).
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "core/time.hpp"

namespace rubicon::parallel {

/// The end of time: when what has nothing to do has its next event.
inline constexpr instant never = instant::max();

[[nodiscard]] constexpr instant later(instant x, duration by) {
  return x > never - by ? never : x + by;
}

/// Who may send to whom, and how long that takes at least.
class horizons {
public:
  /// @param delay of what `from` sends `to`; the least counts. @pre delay > 0
  void link(std::size_t from, std::size_t to, duration delay) {
    links_.push_back({from, to, delay});
  }

  /// What may be sent in less time than this is not a link: nothing, if there is none.
  [[nodiscard]] duration delay(std::size_t from, std::size_t to) const {
    auto least = duration::max();
    for (const auto& x : links_)
      if (x.from == from && x.to == to)
        least = std::min(least, x.delay);
    return least;
  }

  /// @param next when each process does something next, if nobody sends it anything; or never
  /// @returns for each process: whatever is still sent to it comes at this time or later. Valid
  ///          until the next call
  [[nodiscard]] std::span<const instant> of(std::span<const instant> next) {
    // When each does something next at the earliest, if others may cause it.
    earliest_.assign(next.begin(), next.end());
    for (bool changed = true; changed;) {
      changed = false;
      for (const auto& x : links_) {
        const auto arrival = later(earliest_[x.from], x.delay);
        if (arrival < earliest_[x.to]) {
          earliest_[x.to] = arrival;
          changed = true;
        }
      }
    }
    safe_.assign(next.size(), never);
    for (const auto& x : links_)
      safe_[x.to] = std::min(safe_[x.to], later(earliest_[x.from], x.delay));
    return safe_;
  }

private:
  struct one_link {
    std::size_t from = 0;
    std::size_t to = 0;
    duration delay{};
  };

  std::vector<one_link> links_;
  std::vector<instant> earliest_;
  std::vector<instant> safe_;
};

} // namespace rubicon::parallel
