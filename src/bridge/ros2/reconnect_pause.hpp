// How long a bridge waits before it tries to connect again.
#pragma once

#include <algorithm>

#include "core/numbers/random.hpp"
#include "core/time.hpp"

namespace rubicon::bridge {

/// Doubles from 250 ms to 8 s with each attempt that fails; random by a quarter, so that bridges
/// which have lost one server do not return at once.
class reconnect_pause {
public:
  static constexpr duration shortest = 250ms;
  static constexpr duration longest = 8s;

  [[nodiscard]] duration next(random_stream& rng) {
    const auto x = pause_;
    pause_ = std::min<duration>(2 * pause_, longest);
    return rng.between(x - x / 4, x + x / 4);
  }
  void reset() { pause_ = shortest; }

private:
  duration pause_ = shortest;
};

} // namespace rubicon::bridge
