// What a mote or sink knows when it starts: its flash, EEPROM or the like.
#pragma once

#include <cstdint>

#include "core/describe/fields.hpp"

namespace rubicon::mote {

/// All that outlasts a loss of power. Whoever runs the core keeps it, hands it in when the core
/// starts, and replaces it when the core says so. Zeros are a store that was never written.
struct nonvolatile {
  std::uint32_t starts = 0; ///< so often it has been started, by what the store knows
  std::uint32_t term = 0;   ///< the last one that a sink has begun (gateway_lines)
  std::uint8_t era = 0;     ///< of its island's time, the same (network::clock_sync)

  friend bool operator==(const nonvolatile&, const nonvolatile&) = default;
};
RUBICON_FIELDS(nonvolatile, starts, term, era);

/// The store is to hold this from now on. Comes before all that needs it: what others are sent of a
/// life must be in the store already.
struct store_nonvolatile {
  nonvolatile content;
};

/// A life begins. Others know it by the number of lives before (DIS-07), which the store has
/// counted.
/// @returns what the store is to hold now
[[nodiscard]] inline nonvolatile begin_life(nonvolatile x) {
  ++x.starts;
  return x;
}

} // namespace rubicon::mote
