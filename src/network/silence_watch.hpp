// Whether a mote in an island whose radios sleep is out of its neighbours' windows (CLK-04,
// NRG-01).
#pragma once

#include "core/time.hpp"

namespace rubicon::network {

/// A mote whose time is wrong sends while no other listens: its unicasts fail in one window after
/// the other, and it receives nothing.
class silence_watch {
public:
  static constexpr unsigned windows_max = 3;

  silence_watch() = default;
  explicit silence_watch(duration period) : period_(period) {}

  void on_received() { windows_ = 0; }

  /// @returns whether the time is to be distrusted now
  [[nodiscard]] bool on_unicast(bool acked, instant now) {
    if (acked) {
      windows_ = 0;
      return false;
    }
    if (windows_ > 0 && now - last_ < period_ / 2)
      return false;
    last_ = now;
    return ++windows_ == windows_max;
  }

private:
  duration period_{};    ///< of the windows
  unsigned windows_ = 0; ///< in which unicasts have failed since anything was received,
  instant last_;         ///< the last one
};

} // namespace rubicon::network
