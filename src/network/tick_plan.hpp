// How a tick of the RUBICON clock is divided: slots for synaptic vectors first, then a part that is
// free for everything else (SYN-16).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/time.hpp"

namespace rubicon::network {

/// Slots of 4 ms follow each other from the tick on: ten values, their acknowledgement, and 0.8 ms.
/// The last fifth of a tick, at least 40 ms, has none: of 500 ms, 100 slots leave 100 ms. A tick of
/// less than 80 ms is all slots.
///
/// What is free is all after the slots in use; how many these are is told in sevenths.
class tick_plan {
public:
  static constexpr duration slot_length = 4ms;
  static constexpr duration free_min = 40ms;
  /// A frame of the longest size, and what medium access and repeats may add to it.
  static constexpr duration frame_room = 20ms;
  static constexpr std::uint8_t shares = 7;

  /// @pre period > 0
  constexpr explicit tick_plan(duration period)
      : period_(period), rest_(period < 2 * free_min ? 0ns : std::max(period / 5, free_min)) {}

  [[nodiscard]] constexpr std::size_t slots() const {
    return static_cast<std::size_t>(std::max<duration::rep>((period_ - rest_) / slot_length, 1));
  }

  /// How long after the tick the slot of this number begins; nothing: there are not so many.
  [[nodiscard]] constexpr std::optional<duration> slot(std::uint16_t number) const {
    return number < slots() ? std::optional(number * slot_length) : std::nullopt;
  }

  /// So many sevenths of the slots hold the first `used` ones; 0: none is in use.
  [[nodiscard]] constexpr std::uint8_t share_of(std::size_t used) const {
    return static_cast<std::uint8_t>((std::min(used, slots()) * shares + slots() - 1) / slots());
  }

  [[nodiscard]] constexpr bool has_free_part() const { return rest_ > 0ns; }

  /// When the free part begins, and until when a frame may be handed to the radio in it.
  /// @pre has_free_part()
  [[nodiscard]] constexpr duration free_from(std::uint8_t share) const {
    return static_cast<duration::rep>((share * slots() + shares - 1) / shares) * slot_length;
  }
  [[nodiscard]] constexpr duration free_until() const { return period_ - frame_room; }

private:
  duration period_;
  duration rest_;
};

} // namespace rubicon::network
