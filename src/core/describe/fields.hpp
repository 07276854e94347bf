// The fields of a struct, listed once, beside it. What is sent, traced, added up or reported of a
// struct follows from the list.
#pragma once

#include <algorithm>
#include <array>
#include <compare>
#include <concepts>
#include <cstddef>
#include <map>
#include <string_view>
#include <tuple>

namespace rubicon {

template <class Struct, class Value>
struct listed_field {
  std::string_view name;
  Value Struct::*member;
};

template <class Struct, class Value>
constexpr listed_field<Struct, Value> make_field(std::string_view name, Value Struct::*member) {
  return {name, member};
}

/// A struct whose fields are listed with RUBICON_FIELDS.
template <class T>
concept described = requires {
  fields_of(static_cast<const T*>(nullptr));
};

/// As the source calls it, without namespaces.
template <described T>
inline constexpr std::string_view struct_name = name_of_struct(static_cast<const T*>(nullptr));

/// Calls f(name, value) for each field, in the order of the list.
template <class T, class F>
constexpr void for_each_field(T& x, F f) {
  std::apply([&](const auto&... each) { (f(each.name, x.*(each.member)), ...); },
             fields_of(static_cast<const T*>(nullptr)));
}

/// Of several, the largest counts: their sum.
template <class T>
struct largest {
  T value{};

  constexpr largest() = default;
  template <std::convertible_to<T> U>
  constexpr largest(U x) : value(x) {}           // NOLINT(google-explicit-constructor): it is one
  constexpr operator T() const { return value; } // NOLINT(google-explicit-constructor)
  constexpr largest& operator+=(const largest& x) {
    value = std::max(value, x.value);
    return *this;
  }

  friend constexpr auto operator<=>(const largest&, const largest&) = default;
};

/// Field by field: maps by their keys, arrays one by one, `largest` by its rule, all else by its
/// `+=`.
template <described T>
T& operator+=(T& sum, const T& x);

template <class T>
constexpr void add_to(T& sum, const T& x) {
  sum += x;
}

template <class Key, class Count>
void add_to(std::map<Key, Count>& sum, const std::map<Key, Count>& x) {
  for (const auto& [key, count] : x)
    sum[key] += count;
}

template <class Count, std::size_t size>
constexpr void add_to(std::array<Count, size>& sum, const std::array<Count, size>& x) {
  for (std::size_t i = 0; i < size; ++i)
    sum[i] += x[i];
}

template <described T>
T& operator+=(T& sum, const T& x) {
  std::apply([&](const auto&... each) { (add_to(sum.*(each.member), x.*(each.member)), ...); },
             fields_of(&x));
  return sum;
}

} // namespace rubicon

// Each of up to 256 arguments.
#define RUBICON_EXPAND(...)                                                                        \
  RUBICON_EXPAND_4(RUBICON_EXPAND_4(RUBICON_EXPAND_4(RUBICON_EXPAND_4(__VA_ARGS__))))
#define RUBICON_EXPAND_4(...)                                                                      \
  RUBICON_EXPAND_3(RUBICON_EXPAND_3(RUBICON_EXPAND_3(RUBICON_EXPAND_3(__VA_ARGS__))))
#define RUBICON_EXPAND_3(...)                                                                      \
  RUBICON_EXPAND_2(RUBICON_EXPAND_2(RUBICON_EXPAND_2(RUBICON_EXPAND_2(__VA_ARGS__))))
#define RUBICON_EXPAND_2(...)                                                                      \
  RUBICON_EXPAND_1(RUBICON_EXPAND_1(RUBICON_EXPAND_1(RUBICON_EXPAND_1(__VA_ARGS__))))
#define RUBICON_EXPAND_1(...) __VA_ARGS__
#define RUBICON_PARENS ()
#define RUBICON_EACH_FIELD(Struct, name, ...)                                                      \
  ::rubicon::make_field(#name, &Struct::name)                                                      \
      __VA_OPT__(, RUBICON_NEXT_FIELD RUBICON_PARENS(Struct, __VA_ARGS__))
#define RUBICON_NEXT_FIELD() RUBICON_EACH_FIELD

/// After a struct: the names of all its fields, in their order. Does not compile if one is missing.
#define RUBICON_FIELDS(Struct, ...)                                                                \
  template <std::same_as<Struct> T> /* a template is compiled where it is used */                  \
  constexpr auto fields_of(const T*) {                                                             \
    return std::make_tuple(__VA_OPT__(RUBICON_EXPAND(RUBICON_EACH_FIELD(T, __VA_ARGS__))));        \
  }                                                                                                \
  constexpr std::string_view name_of_struct(const Struct*) {                                       \
    return #Struct;                                                                                \
  }                                                                                                \
  [[maybe_unused]] inline void all_fields_are_listed([[maybe_unused]] const Struct& struct_) {     \
    __VA_OPT__([[maybe_unused]] const auto& [__VA_ARGS__] = struct_;)                              \
  }                                                                                                \
  static_assert(true)
