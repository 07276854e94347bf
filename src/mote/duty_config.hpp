// When the radios of an island's motes may be off.
#pragma once

#include <cstddef>

#include "core/time.hpp"

namespace rubicon::mote {

struct duty_config {
  bool enabled = false;    ///< else the radio is always on
  duration period = 4s;    ///< of the island's common window, in which all that keeps to no
                           ///< channel's schedule goes
  duration window = 100ms; ///< its length, from each multiple of the period in island time
  duration settling = 60s; ///< until the island's time shows this all radios stay on
  duration before = 4ms;   ///< ahead of a scheduled packet: clock error and switching on
  duration after = 60ms;   ///< longest wait for one that is late
  duration linger = 6ms;   ///< after a scheduled packet, for its acknowledgement
  std::size_t held_max = 16;

  /// Longest that a frame without a schedule waits for its turn.
  [[nodiscard]] duration delay_max() const { return enabled ? period : duration{}; }
  /// What frames there and back may wait, hops included: for time-outs.
  [[nodiscard]] duration answer_slack() const { return 3 * delay_max(); }
};

} // namespace rubicon::mote
