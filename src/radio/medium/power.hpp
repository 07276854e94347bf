// Signal power as the medium adds it up: whole multiples of 10^-16 mW, so that sums are exact
// whatever the order in which signals come and go.
#pragma once

#include <cstdint>

namespace rubicon::radio {

/// 1 is -160 dBm, 10^16 is 0 dBm; a sum of 1800 signals of 0 dBm still fits.
using power_units = std::uint64_t;

/// Rounded to 24 significant bits, as links store it; 0 below -160 dBm. @pre dbm <= 30
[[nodiscard]] power_units to_units(double dbm);

/// -infinity for 0.
[[nodiscard]] double to_dbm(power_units x);

/// Decibels as a ratio, 10^(x / 10), and back. @pre ratio > 0
[[nodiscard]] double from_db(double db);
[[nodiscard]] double to_db(double ratio);

} // namespace rubicon::radio
