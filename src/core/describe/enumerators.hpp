// Which numbers an enumeration has a name for: what comes from outside may be any.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>
#include <type_traits>
#include <utility>

namespace rubicon {

namespace detail {

/// Numbers from it on are taken for none, whatever has them.
inline constexpr std::size_t enumerators_max = 128;

/// A compiler writes a value without a name as a cast: `(rubicon::part_state)7`, and one with a
/// name perhaps as `(anonymous namespace)::red`.
template <class E, E value>
constexpr bool has_name() {
  constexpr std::string_view text = __PRETTY_FUNCTION__;
  constexpr std::string_view before = "value = ";
  constexpr auto at = text.rfind(before);
  static_assert(at != std::string_view::npos);
  constexpr auto end = text.rfind(')');
  if constexpr (end == std::string_view::npos || end < at)
    return true;
  else
    return text[end + 1] == ':';
}

template <class E, std::size_t... number>
constexpr std::array<bool, sizeof...(number)> named(std::index_sequence<number...> /*all*/) {
  return {has_name<E, static_cast<E>(number)>()...};
}

template <class E>
inline constexpr auto names_of = named<E>(std::make_index_sequence<enumerators_max>());

} // namespace detail

/// Whether it is one of the enumerators that the type lists, below 128.
template <class E>
requires std::is_enum_v<E>
[[nodiscard]] constexpr bool is_enumerator(E x) {
  static_assert(!std::is_convertible_v<E, int>, "an enum class has a value for each number");
  const auto number = static_cast<std::underlying_type_t<E>>(x);
  if constexpr (std::is_signed_v<std::underlying_type_t<E>>)
    if (number < 0)
      return false;
  return static_cast<std::size_t>(number) < detail::enumerators_max &&
         detail::names_of<E>[static_cast<std::size_t>(number)];
}

} // namespace rubicon
