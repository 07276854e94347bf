// How long a client of some server waits before it tries to connect again.
#pragma once

#include <algorithm>

#include "core/numbers/random.hpp"
#include "core/time.hpp"

namespace rubicon {

/// Doubles with each attempt that fails; random by a quarter, so that clients which have lost one
/// server do not return at once.
class reconnect_pause {
public:
  /// @param shortest the first one, longer than 0; @param longest not shorter than that
  reconnect_pause(duration shortest, duration longest)
      : shortest_(shortest), longest_(longest), pause_(shortest) {}

  [[nodiscard]] duration next(random_stream& rng) {
    const auto x = pause_;
    pause_ = std::min<duration>(2 * pause_, longest_);
    return rng.between(x - x / 4, x + x / 4);
  }
  void reset() { pause_ = shortest_; }

private:
  duration shortest_;
  duration longest_;
  duration pause_;
};

} // namespace rubicon
