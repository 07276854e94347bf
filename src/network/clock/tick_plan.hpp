// How a tick of the RUBICON clock is divided: slots for synaptic vectors first, then a part that is
// free for everything else (SYN-16).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/time.hpp"

namespace rubicon::network {

/// A row of units of a tick, in which one mote sends its vectors; none: it has no slot.
struct slot_run {
  std::uint16_t first = 0;
  std::uint16_t units = 0;

  [[nodiscard]] constexpr std::size_t end() const { return std::size_t{first} + units; }
  friend constexpr bool operator==(const slot_run&, const slot_run&) = default;
};

/// Slots follow each other from the tick on, each as many units of 1 ms long as its vectors need
/// over all their hops (network/slot_time.hpp). The last fifth of a tick, at least 40 ms, has none:
/// of 500 ms, 400 units leave 100 ms. A tick of less than 80 ms is all units.
///
/// What is free is all after the slots in use; how many units these are is given in sevenths.
class tick_plan {
public:
  static constexpr duration unit = 1ms;
  static constexpr duration free_min = 40ms;
  /// A frame of the longest size, and what medium access and repeats may add to it.
  static constexpr duration frame_room = 20ms;
  static constexpr std::uint8_t shares = 7;

  /// @pre period > 0
  constexpr explicit tick_plan(duration period)
      : period_(period), rest_(period < 2 * free_min ? 0ns : std::max(period / 5, free_min)) {}

  [[nodiscard]] constexpr std::size_t units() const {
    return static_cast<std::size_t>(std::max<duration::rep>((period_ - rest_) / unit, 1));
  }

  /// How long after the tick the slot begins; nothing: there is none, or the tick has no such
  /// units.
  [[nodiscard]] constexpr std::optional<duration> begin(const slot_run& x) const {
    return x.units > 0 && x.end() <= units() ? std::optional(x.first * unit) : std::nullopt;
  }

  /// So many sevenths of the units hold the first `used` ones; 0: none is in use.
  [[nodiscard]] constexpr std::uint8_t share_of(std::size_t used) const {
    return static_cast<std::uint8_t>((std::min(used, units()) * shares + units() - 1) / units());
  }

  [[nodiscard]] constexpr bool has_free_part() const { return rest_ > 0ns; }

  /// When the free part begins, and until when a frame may be handed to the radio in it.
  /// @pre has_free_part()
  [[nodiscard]] constexpr duration free_from(std::uint8_t share) const {
    return static_cast<duration::rep>((share * units() + shares - 1) / shares) * unit;
  }
  [[nodiscard]] constexpr duration free_until() const { return period_ - frame_room; }

private:
  duration period_;
  duration rest_;
};

} // namespace rubicon::network
