// When a mote requests more rounds of the clock from the sink (CLK-01).
#pragma once

#include <optional>

#include "core/numbers/random.hpp"
#include "core/time.hpp"

namespace rubicon::network {

/// Motes that are as far from the sink as this one, or at the same temperature, need the same: a
/// request leaves after a random time, unless another mote's was answered.
class period_requests {
public:
  static constexpr duration gap = 1min; ///< between two
  static constexpr duration spread = 10s;

  period_requests() = default;
  explicit period_requests(instant now) : requested_(now - gap) {}

  void on_round(instant now);

  /// @param wanted period of the rounds; nothing: it is short enough
  /// @returns the period to request now
  [[nodiscard]] std::optional<duration> on_time(std::optional<duration> wanted, instant now,
                                                random_stream& rng);
  [[nodiscard]] std::optional<instant> deadline() const { return due_; }

private:
  std::optional<instant> round_; ///< when the last one was received,
  duration period_{};            ///< and how long after the one before
  std::optional<instant> due_;
  instant requested_; ///< when a request was sent last
};

} // namespace rubicon::network
