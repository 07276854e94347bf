// What the record of a run has of one message between actors.
#pragma once

#include <cstdint>

#include "explain/record.hpp"
#include "scheduler/trace.hpp"

namespace rubicon {

/// Fills in the kind and what is of that kind alone: neither number, time, receiver nor cause.
/// @returns whether it is worth a record
[[nodiscard]] bool fill_record(explain::record& r, const scheduler::delivery& x);

/// Beacons are worth none, wherever they are seen.
[[nodiscard]] bool is_beacon(std::uint8_t am_type);

} // namespace rubicon
