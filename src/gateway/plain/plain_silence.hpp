// Whether a serial forwarder to plain motes may hang: it accepts packets whatever becomes of them.
#pragma once

#include <algorithm>
#include <optional>
#include <utility>

#include "core/time.hpp"

namespace rubicon::gateway {

class plain_silence {
public:
  plain_silence() = default;
  /// @param least so long a pause is no silence yet
  explicit plain_silence(duration least) : least_(least) {}

  /// A packet of a plain mote was received.
  void on_packet(instant now) {
    const auto before = std::exchange(last_packet_, now);
    longest_pause_ = std::max(longest_pause_, before ? now - *before : duration{});
  }

  /// Whether nothing was received for so long that their forwarder may hang.
  [[nodiscard]] bool is_silent(instant now) const {
    return !last_packet_ || now - *last_packet_ >= std::max(least_, 2 * longest_pause_);
  }

private:
  duration least_{};
  std::optional<instant> last_packet_;
  duration longest_pause_{}; ///< between two packets
};

} // namespace rubicon::gateway
