// Which values a study gives to which parameters, and the variants that follow.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace rubicon::study {

/// A key or parameter of a file, and the values that it is given.
struct variation {
  std::string path;
  std::vector<std::string> values; ///< as a setting has them
};

inline constexpr std::size_t values_max = 10'000;
inline constexpr std::size_t variants_max = 100'000;

/// `loss=0,0.1,0.2` is a list, whose commas within brackets and quotes separate nothing;
/// `range=15m..40m/5` counts from the first to at most the last in steps, which have the same unit
/// or none; or the reason why it is neither.
[[nodiscard]] std::variant<variation, std::string> parse_variation(std::string_view text);

/// A value of each variation, in their order.
using variant_values = std::vector<std::string>;

/// All combinations, the last variation changing fastest; one without values if nothing varies.
/// @returns the reason if there are more than variants_max
[[nodiscard]] std::variant<std::vector<variant_values>, std::string>
variants_of(const std::vector<variation>& all);

} // namespace rubicon::study
