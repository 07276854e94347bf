// The island of which the tests of actors play a part.
#pragma once

#include <string_view>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "support/mote_ids.hpp"

namespace rubicon::test {

inline constexpr island_id kitchen{5};
inline constexpr mote_address stove{kitchen, mote_id{2}};
inline constexpr mote_address heater{kitchen, mote_id{7}};

[[nodiscard]] inline payload text(std::string_view x) {
  return to_bytes(x);
}

} // namespace rubicon::test
