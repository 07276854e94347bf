// The common window of an island whose radios sleep: when all of them are on (NRG-01).
#pragma once

#include "core/time.hpp"
#include "network/clock/time_estimate.hpp"

namespace rubicon::network {

struct duty_window {
  duration period{};       ///< of the window; 0: radios are always on
  duration length = 100ms; ///< from each multiple of the period in island time
  duration settling = 60s; ///< until the island's time shows this all radios stay on

  [[nodiscard]] bool enabled() const { return period > 0s; }

  /// Whether others may be asleep, and we know when they are not.
  [[nodiscard]] bool applies(instant now, const time_estimate& clock) const {
    return enabled() && knows_time(now, clock) &&
           clock.at(now).time_since_epoch() >=
               std::chrono::floor<std::chrono::microseconds>(settling);
  }

  /// Who does not is on all the time, and asks.
  [[nodiscard]] bool knows_time(instant now, const time_estimate& clock) const {
    return clock.synchronised() && clock.doubt(now) <= length / 2;
  }
};

} // namespace rubicon::network
