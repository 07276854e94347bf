// The time that all peers share, and until when it is believed (CLK-06).
#pragma once

#include <chrono>

#include "core/time.hpp"

namespace rubicon {

/// Neither peers, sinks nor motes believe a network time from here on, the year 2150: nanoseconds
/// since 1970 end in 2262, and an expiry may be 68 years ahead.
inline constexpr duration network_time_end = std::chrono::seconds(5'680'281'600);

} // namespace rubicon
