// What the key of a tuple may measure, and how many parts one has (TUP-03).
#pragma once

#include <algorithm>
#include <cstddef>
#include <string_view>

namespace rubicon {

inline constexpr std::size_t key_characters_max = 127;
inline constexpr std::size_t key_parts_max = 7;

/// Between its dots; 0 of the empty key.
[[nodiscard]] constexpr std::size_t key_parts_of(std::string_view key) {
  return key.empty() ? 0 : 1 + static_cast<std::size_t>(std::ranges::count(key, '.'));
}

/// Neither longer nor of more parts than a key may be.
[[nodiscard]] constexpr bool fits_tuple_key(std::string_view key) {
  return key.size() <= key_characters_max && key_parts_of(key) <= key_parts_max;
}

} // namespace rubicon
