// What may be a name: it fits in one part of a tuple's key, in an actor's path and in a
// certificate.
#pragma once

#include <cstddef>
#include <string_view>

namespace rubicon {

inline constexpr std::size_t name_length_max = 32;

/// A letter, a digit, `-` or `_`.
[[nodiscard]] bool is_name_character(char c);

/// 1 to name_length_max such characters.
[[nodiscard]] bool is_name(std::string_view x);

} // namespace rubicon
