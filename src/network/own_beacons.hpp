// Which beacon a mote sends next, and when.
#pragma once

#include <cstdint>

#include "core/time.hpp"
#include "network/tree/trickle.hpp"

namespace rubicon::network {

/// At most one is in flight. One that repeats the last one has its number, and counts as the same;
/// where radios sleep it is extra: sent while neighbours do not listen, so that it takes no other
/// one's place.
class own_beacons {
public:
  own_beacons() = default;
  explicit own_beacons(trickle timer) : timer_(std::move(timer)) {}

  [[nodiscard]] const trickle& timer() const { return timer_; }
  [[nodiscard]] trickle& timer() { return timer_; }

  /// One is due, as soon as there is a turn for it.
  void request() { is_due_ = true; }
  void on_time(instant now) { is_due_ = timer_.on_time(now) || is_due_; }
  [[nodiscard]] bool is_due() const { return is_due_; }
  void clear() { is_due_ = false; }

  [[nodiscard]] bool has_sent() const { return sequence_ > 0; }
  [[nodiscard]] bool is_in_flight() const { return is_in_flight_; }
  /// @param repeats the last one @returns its number @pre !is_in_flight()
  [[nodiscard]] std::uint16_t begin(bool repeats) {
    is_in_flight_ = true;
    return repeats ? sequence_ : ++sequence_;
  }
  void on_sent() { is_in_flight_ = false; }

private:
  trickle timer_;
  std::uint16_t sequence_ = 0;
  bool is_in_flight_ = false;
  bool is_due_ = false;
};

} // namespace rubicon::network
