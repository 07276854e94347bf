// When to try again to get what a serial line needs of the outside: a port, a connection.
#pragma once

#include <algorithm>
#include <optional>

#include "core/time.hpp"

namespace rubicon::serial {

/// At first after half a second, then twice as late each time, at most every ten seconds. Something
/// that has lasted for ten seconds was no mistake: the next time begins with half a second again.
class reopening {
public:
  static constexpr duration first = 500ms;
  static constexpr duration longest = 10s;

  void on_opened(instant now) { since_ = now; }

  /// It could not be had, or it has gone. @returns how long to wait
  [[nodiscard]] duration on_closed(instant now) {
    if (since_ && now - *since_ >= longest)
      next_ = first;
    since_.reset();
    const auto wait = next_;
    next_ = std::min(2 * next_, longest);
    return wait;
  }

private:
  std::optional<instant> since_; ///< when it was opened
  duration next_ = first;
};

} // namespace rubicon::serial
