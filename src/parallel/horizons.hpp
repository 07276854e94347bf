// How far logical processes may run ahead of each other: conservative parallel simulation, without
// rollback (Chandy and Misra 1979; Fujimoto, Parallel and Distributed Simulation Systems, 2000).
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>
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
    const auto place = place_of(from, to);
    if (place != links_.end() && place->ends() == std::pair(from, to))
      links_[static_cast<std::size_t>(place - links_.begin())].delay =
          std::min(place->delay, delay);
    else
      links_.insert(place, {from, to, delay});
  }

  /// What may be sent in less time than this is not a link: nothing, if there is none.
  /// It is asked for each message between two processes, and finds the answer among all links in
  /// logarithmic time.
  [[nodiscard]] duration delay(std::size_t from, std::size_t to) const {
    const auto place = place_of(from, to);
    const bool is_found = place != links_.end() && place->ends() == std::pair(from, to);
    return is_found ? place->delay : duration::max();
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

    [[nodiscard]] std::pair<std::size_t, std::size_t> ends() const { return {from, to}; }
  };

  /// Where this link is, or would be.
  [[nodiscard]] std::vector<one_link>::const_iterator place_of(std::size_t from,
                                                               std::size_t to) const {
    return std::ranges::lower_bound(links_, std::pair(from, to), {}, &one_link::ends);
  }

  std::vector<one_link> links_; ///< one for each pair of ends, ascending by them
  std::vector<instant> earliest_;
  std::vector<instant> safe_;
};

} // namespace rubicon::parallel
