// Quantities as people write them: a number and its unit, `31s`, `1min30s`, `2%`, `25m`, `2000mAh`,
// `-98dBm`.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "core/time.hpp"

namespace rubicon::config {

/// One or more numbers with the units ns, us, ms, s, min, h, d, the larger first; decimals as far
/// as they are whole nanoseconds; blanks allowed between number and unit and between parts. Nothing
/// for any other text, a missing unit, a sign, or more than 292 years.
[[nodiscard]] std::optional<duration> parse_duration(std::string_view text);

/// `2%` is 0.02. The range is the caller's concern, here and below; a sign or an exponent is
/// refused.
[[nodiscard]] std::optional<double> parse_ratio(std::string_view text);

/// Metres, of cm, m or km.
[[nodiscard]] std::optional<double> parse_length_m(std::string_view text);

/// What energies are counted by: two AA cells, as the batteries of all platforms (tinyos.md 8.2).
inline constexpr double battery_v = 3;

/// Milliampere hours, of mAh or Ah, or of J or kJ at battery_v.
[[nodiscard]] std::optional<double> parse_charge_mah(std::string_view text);

/// dBm or dB, with a minus in front or none.
[[nodiscard]] std::optional<double> parse_dbm(std::string_view text);
[[nodiscard]] std::optional<double> parse_db(std::string_view text);

/// Megahertz, of MHz or GHz.
[[nodiscard]] std::optional<double> parse_frequency_mhz(std::string_view text);

/// Bits a second, of bit/s, kbit/s, Mbit/s or Gbit/s.
[[nodiscard]] std::optional<double> parse_bit_rate_bps(std::string_view text);

/// Bits a second, of a whole number of baud or the name of a platform of TinyOS.
[[nodiscard]] std::optional<std::int64_t> parse_baud(std::string_view text);

} // namespace rubicon::config
