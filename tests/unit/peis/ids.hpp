// Who takes part in tests of peers, and when they begin.
#pragma once

#include "core/address.hpp"
#include "core/time.hpp"

namespace rubicon::peis::test {

inline constexpr peer_id me{1};
inline constexpr peer_id robot{2};
inline constexpr peer_id hostile{3};
inline constexpr instant start{100s};

} // namespace rubicon::peis::test
