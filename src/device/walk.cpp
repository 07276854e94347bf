#include "device/walk.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace rubicon::device {

walk::walk(std::vector<waypoint> path, duration step) : path_(std::move(path)), step_(step) {
  assert(step > 0s);
}

position walk::at(instant now) const {
  const auto time = now.time_since_epoch();
  const auto ahead = std::ranges::upper_bound(path_, time, {}, &waypoint::at);
  if (ahead == path_.begin())
    return path_.front().place;
  if (ahead == path_.end())
    return path_.back().place;
  const auto& a = *(ahead - 1);
  const auto& b = *ahead;
  const auto share = seconds(time - a.at) / seconds(b.at - a.at);
  return {a.place.x_m + share * (b.place.x_m - a.place.x_m),
          a.place.y_m + share * (b.place.y_m - a.place.y_m),
          a.place.z_m + share * (b.place.z_m - a.place.z_m)};
}

std::optional<instant> walk::next(instant now) const {
  const auto time = now.time_since_epoch();
  const auto ahead = std::ranges::upper_bound(path_, time, {}, &waypoint::at);
  if (ahead == path_.end())
    return std::nullopt;
  const bool stands = ahead == path_.begin() || (ahead - 1)->place == ahead->place;
  return instant(stands ? ahead->at : std::min(ahead->at, time + step_));
}

} // namespace rubicon::device
