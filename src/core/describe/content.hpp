// What a value holds, folded into a hash or printed for people: numbers, texts, octets, times,
// containers of such, and structs whose fields are listed (core/describe/fields.hpp).
#pragma once

#include <bit>
#include <charconv>
#include <chrono>
#include <concepts>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <variant>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/describe/fields.hpp"
#include "core/hash.hpp"
#include "core/time.hpp"

namespace rubicon {

namespace detail {

/// A type that says itself what it holds.
template <class T>
concept self_describing = requires(const T& x, fold64& into, std::string& out) {
  x.fold_into(into);
  x.print_to(out);
};

template <class T>
concept sequence = requires(const T& x) {
  x.begin();
  x.end();
  x.size();
};

template <class T>
concept named_enum = std::is_enum_v<T> && requires(T x) {
  { to_string(x) } -> std::convertible_to<std::string_view>;
};

template <class T>
inline constexpr bool is_optional = false;
template <class T>
inline constexpr bool is_optional<std::optional<T>> = true;

template <class T>
inline constexpr bool is_variant = false;
template <class... Each>
inline constexpr bool is_variant<std::variant<Each...>> = true;

template <class T>
inline constexpr bool is_pair = false;
template <class A, class B>
inline constexpr bool is_pair<std::pair<A, B>> = true;

template <class T>
inline constexpr bool is_strong_id = false;
template <class Tag, class Rep>
inline constexpr bool is_strong_id<strong_id<Tag, Rep>> = true;

template <class T>
inline constexpr bool is_largest = false;
template <class T>
inline constexpr bool is_largest<largest<T>> = true;

template <class T>
inline constexpr bool is_duration = false;
template <class Rep, class Period>
inline constexpr bool is_duration<std::chrono::duration<Rep, Period>> = true;

} // namespace detail

/// Adds all that `x` holds to a hash: the same on every machine, and in the order of the fields.
template <class T>
void fold_content(fold64& into, const T& x) {
  if constexpr (detail::self_describing<T>) {
    x.fold_into(into);
  } else if constexpr (std::is_integral_v<T> || std::is_enum_v<T>) {
    into.add(static_cast<std::uint64_t>(x));
  } else if constexpr (std::is_same_v<T, double>) {
    into.add(std::bit_cast<std::uint64_t>(x));
  } else if constexpr (std::is_same_v<T, float>) {
    into.add(std::bit_cast<std::uint32_t>(x));
  } else if constexpr (std::is_same_v<T, payload>) {
    into.add(x.view());
  } else if constexpr (std::is_same_v<T, bytes>) {
    into.add(byte_view(x));
  } else if constexpr (std::is_convertible_v<const T&, std::string_view>) {
    into.add(std::string_view(x));
  } else if constexpr (std::is_same_v<T, instant>) {
    into.add(static_cast<std::uint64_t>(x.time_since_epoch().count()));
  } else if constexpr (detail::is_duration<T>) {
    into.add(static_cast<std::uint64_t>(x.count()));
  } else if constexpr (detail::is_strong_id<T> || detail::is_largest<T>) {
    fold_content(into, x.value);
  } else if constexpr (detail::is_optional<T>) {
    into.add(static_cast<std::uint64_t>(x.has_value()));
    if (x)
      fold_content(into, *x);
  } else if constexpr (detail::is_variant<T>) {
    into.add(x.index());
    std::visit([&into](const auto& y) { fold_content(into, y); }, x);
  } else if constexpr (detail::is_pair<T>) {
    fold_content(into, x.first);
    fold_content(into, x.second);
  } else if constexpr (detail::sequence<T>) {
    into.add(x.size());
    for (const auto& each : x)
      fold_content(into, each);
  } else {
    static_assert(described<T>, "its fields are not listed");
    for_each_field(x, [&into](std::string_view, const auto& each) { fold_content(into, each); });
  }
}

/// Octets that the values in `x` take, without names and counts.
template <class T>
[[nodiscard]] std::size_t content_size(const T& x) {
  if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
    return sizeof(T);
  } else if constexpr (std::is_same_v<T, payload> || std::is_same_v<T, bytes>) {
    return x.size();
  } else if constexpr (std::is_convertible_v<const T&, std::string_view>) {
    return std::string_view(x).size();
  } else if constexpr (std::is_same_v<T, instant> || detail::is_duration<T>) {
    return sizeof(std::int64_t);
  } else if constexpr (detail::is_strong_id<T> || detail::is_largest<T>) {
    return sizeof(x.value);
  } else if constexpr (detail::is_optional<T>) {
    return x ? content_size(*x) : 0;
  } else if constexpr (detail::is_variant<T>) {
    return std::visit([](const auto& y) { return content_size(y); }, x);
  } else if constexpr (detail::is_pair<T>) {
    return content_size(x.first) + content_size(x.second);
  } else if constexpr (detail::sequence<T>) {
    std::size_t sum = 0;
    for (const auto& each : x)
      sum += content_size(each);
    return sum;
  } else if constexpr (described<T>) {
    std::size_t sum = 0;
    for_each_field(x, [&sum](std::string_view, const auto& each) { sum += content_size(each); });
    return sum;
  } else {
    static_assert(detail::self_describing<T>);
    return 0;
  }
}

namespace detail {

void print_text(std::string& out, std::string_view x); ///< in quotes
void print_octets(std::string& out, byte_view x);      ///< as hexadecimal digits
void print_number(std::string& out, double x);

} // namespace detail

/// Appends what `x` holds, structs as `name(field=value, field=value)`.
template <class T>
void print_content(std::string& out, const T& x) {
  if constexpr (detail::self_describing<T>) {
    x.print_to(out);
  } else if constexpr (std::is_same_v<T, bool>) {
    out += x ? "true" : "false";
  } else if constexpr (std::is_integral_v<T>) {
    out += std::to_string(x);
  } else if constexpr (detail::named_enum<T>) {
    out += to_string(x);
  } else if constexpr (std::is_enum_v<T>) {
    out += std::to_string(static_cast<std::underlying_type_t<T>>(x));
  } else if constexpr (std::is_floating_point_v<T>) {
    detail::print_number(out, static_cast<double>(x));
  } else if constexpr (std::is_same_v<T, payload>) {
    detail::print_octets(out, x.view());
  } else if constexpr (std::is_same_v<T, bytes>) {
    detail::print_octets(out, x);
  } else if constexpr (std::is_convertible_v<const T&, std::string_view>) {
    detail::print_text(out, x);
  } else if constexpr (std::is_same_v<T, instant>) {
    out += to_text(x);
  } else if constexpr (detail::is_duration<T>) {
    out += to_text(std::chrono::duration_cast<duration>(x));
  } else if constexpr (detail::is_strong_id<T> || detail::is_largest<T>) {
    print_content(out, x.value);
  } else if constexpr (std::is_same_v<T, mote_address>) {
    out += to_string(x);
  } else if constexpr (detail::is_optional<T>) {
    if (x)
      print_content(out, *x);
    else
      out += "none";
  } else if constexpr (detail::is_variant<T>) {
    std::visit([&out](const auto& y) { print_content(out, y); }, x);
  } else if constexpr (detail::is_pair<T>) {
    print_content(out, x.first);
    out += ": ";
    print_content(out, x.second);
  } else if constexpr (detail::sequence<T>) {
    out += '[';
    bool first = true;
    for (const auto& each : x) {
      out += std::exchange(first, false) ? "" : ", ";
      print_content(out, each);
    }
    out += ']';
  } else {
    static_assert(described<T>, "its fields are not listed");
    out += struct_name<T>;
    out += '(';
    bool first = true;
    for_each_field(x, [&](std::string_view name, const auto& each) {
      out += std::exchange(first, false) ? "" : ", ";
      out += name;
      out += '=';
      print_content(out, each);
    });
    out += ')';
  }
}

} // namespace rubicon
