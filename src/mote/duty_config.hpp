// When the radios of an island's motes may be off.
#pragma once

#include "core/time.hpp"
#include "network/duty_window.hpp"

namespace rubicon::mote {

struct duty_config {
  bool enabled = false;    ///< else the radio is always on
  duration period = 4s;    ///< of the island's common window, in which all that keeps to no
                           ///< channel's schedule goes
  duration window = 100ms; ///< its length, from each multiple of the period in island time
  duration settling = 60s; ///< until the island's time shows this all radios stay on
  duration before =
      1500us; ///< ahead of what is due, beside the uncertainty of the clocks: switching on
  duration after = 40ms;  ///< longest wait for a scheduled packet that is late
  duration linger = 12ms; ///< after each copy of a packet: its acknowledgement may be lost

  [[nodiscard]] network::duty_window common() const {
    return enabled ? network::duty_window{period, window, settling} : network::duty_window{};
  }

  /// A mote that is received once in each window is not gone before so many have passed without it.
  [[nodiscard]] duration silence_min() const { return enabled ? 3 * period : duration{}; }

  /// What frames there and back may wait for their windows: for time-outs. One window carries a
  /// frame over several hops, unless they get lost.
  [[nodiscard]] duration answer_slack(unsigned hops) const {
    return enabled ? static_cast<duration::rep>(2 + hops) * period : duration{};
  }
};

} // namespace rubicon::mote
