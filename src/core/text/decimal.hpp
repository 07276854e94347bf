// Numbers as people write them: the same text on every machine and under every locale.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace rubicon {

/// `value` rounded to `decimals` digits after the point, nearest first, ties of the double itself
/// to even. No exponent, no `-0`. @pre value is finite, decimals in 0..6
[[nodiscard]] std::string decimal_text(double value, int decimals);

/// The fewest digits that mean this double: `2.5`, `1e+20`. Empty if it is not finite.
[[nodiscard]] std::string shortest_decimal(double value);

/// The number that the whole text is, as std::from_chars reads it; nothing if it is none or not
/// finite.
[[nodiscard]] std::optional<double> number_in(std::string_view text);

} // namespace rubicon
