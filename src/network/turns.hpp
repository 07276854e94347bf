// When frames without a slot may leave, so that synaptic vectors have their slots for themselves
// (SYN-16).
#pragma once

#include <cstdint>
#include <optional>

#include "core/random.hpp"
#include "core/time.hpp"
#include "network/clock_sync.hpp"

namespace rubicon::network {

/// At any time, unless the island's clock says that slots are in use: then in the free part of each
/// tick (network/tick_plan.hpp), from a moment on that is drawn anew each time: those who have
/// waited begin spread over as long as they have, or over half the free part. A sink, which most of
/// them talk to, is first.
class turns {
public:
  turns() = default;
  turns(bool is_sink, random_stream dice) : is_sink_(is_sink), dice_(dice) {}

  /// @returns `now`, or the next moment at which a frame without a slot may be handed to the radio
  [[nodiscard]] instant next(instant now, const clock_sync& clock);

  /// The longest wait for it.
  [[nodiscard]] static duration longest(instant now, const clock_sync& clock);

  [[nodiscard]] static std::size_t footprint() { return 4; }

private:
  bool is_sink_ = false;
  random_stream dice_;
  std::optional<std::int64_t> drawn_for_; ///< number of a tick
  duration offset_{};                     ///< from the beginning of its free part
};

} // namespace rubicon::network
