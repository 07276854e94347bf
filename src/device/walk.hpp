// The walk of a mote that moves, in steps.
#pragma once

#include <optional>
#include <vector>

#include "core/time.hpp"
#include "device/waypoint.hpp"

namespace rubicon::device {

/// Straight from one waypoint to the next; before the first it stands there, after the last it
/// stays.
class walk {
public:
  walk() = default;
  /// @param path ascending by time, or empty: it does not move at all
  /// @param step > 0
  walk(std::vector<waypoint> path, duration step);

  /// @pre the path is not empty
  [[nodiscard]] position at(instant now) const;

  /// When its place is to be brought up to date after `now`: every step while it moves, and at each
  /// waypoint; nothing after the last.
  [[nodiscard]] std::optional<instant> next(instant now) const;

  [[nodiscard]] bool empty() const { return path_.empty(); }

private:
  std::vector<waypoint> path_;
  duration step_ = 1s;
};

} // namespace rubicon::device
