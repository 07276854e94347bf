// Ids of motes, short to write.
#pragma once

#include <cstdint>

#include "core/address.hpp"

namespace rubicon::test {

inline constexpr island_id the_island{1};
inline constexpr mote_id the_sink{1};

[[nodiscard]] inline mote_id id(int x) {
  return mote_id{static_cast<std::uint16_t>(x)};
}

} // namespace rubicon::test
