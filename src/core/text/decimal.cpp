#include "core/text/decimal.hpp"

#include <array>
#include <cassert>
#include <charconv>
#include <cmath>

namespace rubicon {

std::string decimal_text(double value, int decimals) {
  assert(decimals >= 0 && decimals <= 6);
  std::array<char, 352> digits{}; // the largest double has 309 digits before the point
  const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), value,
                                          std::chars_format::fixed, decimals);
  assert(error == std::errc{});
  std::string text(digits.data(), end);
  if (text.starts_with('-') && text.find_first_not_of("-0.") == std::string::npos)
    text.erase(0, 1);
  return text;
}

std::string shortest_decimal(double value) {
  if (!std::isfinite(value))
    return {};
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  return {digits.data(), end};
}

std::optional<double> number_in(std::string_view text) {
  double value = 0;
  const auto* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || stop != end || !std::isfinite(value))
    return std::nullopt;
  return value;
}

} // namespace rubicon
