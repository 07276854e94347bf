// Which group is meant: in clear in each frame (SMP-14).
#pragma once

#include <cstdint>

#include "core/address.hpp"

namespace rubicon::smepp {

struct group_tag;

/// 1..65535, chosen by who creates the group.
using group_id = strong_id<group_tag, std::uint16_t>;

/// Frames of no group: under the network keys alone.
inline constexpr group_id network_level{0};

} // namespace rubicon::smepp
