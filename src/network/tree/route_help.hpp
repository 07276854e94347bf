// How often a mote acts for those without a route to the sink, itself among them.
#pragma once

#include <optional>

#include "core/time.hpp"

namespace rubicon::network {

struct route_help_config {
  duration seek_length = 30s; ///< after a route is lost beacons are frequent for so long
  duration help_gap = 2s;     ///< between beacons sent soon for others without a route

  /// Between requests for the sink's next sequence number; of a sink between its answers.
  duration sequence_gap = 20s;
};

/// Each of these is limited in rate.
class route_help {
public:
  route_help() = default;
  route_help(route_help_config config, instant now)
      : config_(config), seek_end_(now + config.seek_length),
        helped_(now - route_help_config().help_gap) {}

  void on_lost(instant now) { seek_end_ = now + config_.seek_length; }
  /// Whether the mote may still look for a route with frequent beacons.
  [[nodiscard]] bool may_seek(instant now) const { return now < seek_end_; }

  /// A neighbour would be helped by a beacon. @returns whether one is to be sent soon
  [[nodiscard]] bool take_help(instant now) { return take(helped_, config_.help_gap, now); }

  /// @returns whether a newer sequence number may be requested, or sent, now
  [[nodiscard]] bool take_sequence(instant now) {
    if (!sequence_taken_) {
      sequence_taken_ = now;
      return true;
    }
    return take(*sequence_taken_, config_.sequence_gap, now);
  }

private:
  [[nodiscard]] static bool take(instant& last, duration gap, instant now) {
    if (now - last < gap)
      return false;
    last = now;
    return true;
  }

  route_help_config config_;
  instant seek_end_;
  instant helped_;
  std::optional<instant> sequence_taken_;
};

} // namespace rubicon::network
