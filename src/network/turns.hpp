// When frames without a slot or schedule may leave, so that synaptic vectors have their slots for
// themselves (SYN-16), and radios that sleep are on (NRG-01).
#pragma once

#include <cstdint>
#include <optional>

#include "core/numbers/random.hpp"
#include "core/time.hpp"
#include "network/clock/time_estimate.hpp"
#include "network/duty_window.hpp"

namespace rubicon::network {

/// At any time, unless the island's clock says that slots are in use: then in the free part of each
/// tick (network/clock/tick_plan.hpp), from a moment on that is drawn anew each time: those who
/// have waited begin spread over as long as they have, or over half the free part. In an island
/// whose radios sleep: in the first three quarters of each common window, from when those are on
/// who know the time no better than we do; who has waited begins spread over its first half. A
/// sink, which most of them talk to, is first.
class turns {
public:
  turns() = default;
  turns(bool is_sink, duty_window window, random_stream rng)
      : is_sink_(is_sink), window_(window), rng_(rng) {}

  /// @returns `now`, or the next moment at which a frame without a slot may be handed to the radio
  [[nodiscard]] instant next(instant now, const time_estimate& clock);

  /// The longest wait for it.
  [[nodiscard]] duration longest(instant now, const time_estimate& clock) const;

  [[nodiscard]] static std::size_t footprint() { return 4; }

private:
  [[nodiscard]] instant next_in_window(instant now, const time_estimate& clock);
  [[nodiscard]] duration draw(std::int64_t number, duration spread);

  bool is_sink_ = false;
  duty_window window_;
  random_stream rng_;
  std::optional<std::int64_t> drawn_for_; ///< number of a tick or window
  duration offset_{};                     ///< from when it is free
};

} // namespace rubicon::network
