// CAF's inspect for the core types: what makes them sendable to another computer.
#pragma once

#include <optional>
#include <tuple>
#include <type_traits>

#include <caf/deserializer.hpp>
#include <caf/meta/hex_formatted.hpp>
#include <caf/meta/type_name.hpp>
#include <caf/serializer.hpp>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/fields.hpp"
#include "core/time.hpp"

namespace rubicon {

template <class Inspector, class Tag, class Rep>
typename Inspector::result_type inspect(Inspector& f, strong_id<Tag, Rep>& x) {
  return f(x.value);
}

template <class Inspector>
typename Inspector::result_type inspect(Inspector& f, payload& x) {
  if constexpr (std::is_base_of_v<caf::serializer, Inspector>) {
    const auto octets = x.view();
    auto size = octets.size();
    if (auto error = f.begin_sequence(size))
      return error;
    if (size > 0) {
      if (auto error = f.apply_raw(size, const_cast<std::uint8_t*>(octets.data())))
        return error;
    }
    return f.end_sequence();
  } else if constexpr (std::is_base_of_v<caf::deserializer, Inspector>) {
    bytes octets;
    auto result = f(octets);
    x = payload(std::move(octets));
    return result;
  } else {
    auto octets = to_bytes(x.view());
    return f(caf::meta::type_name("payload"), caf::meta::hex_formatted(), octets);
  }
}

/// CAF 0.17 knows no std::optional.
template <class T>
struct optional_field {
  std::optional<T>& value;
};

template <class Inspector, class T>
typename Inspector::result_type inspect(Inspector& f, optional_field<T>& x) {
  bool is_there = x.value.has_value();
  auto content = x.value.value_or(T{});
  if constexpr (std::is_base_of_v<caf::deserializer, Inspector>) {
    auto error = f(is_there, content);
    x.value = is_there ? std::optional(content) : std::nullopt;
    return error;
  } else {
    return f(is_there, content);
  }
}

template <class T>
T& inspectable(T& x) {
  return x;
}

template <class T>
optional_field<T> inspectable(std::optional<T>& x) {
  return {x};
}

template <class Inspector, class T>
typename Inspector::result_type inspect_fields(Inspector& f, T& x, const char* type_name) {
  return std::apply(
      [&](const auto&... each) {
        std::tuple<decltype(inspectable(x.*(each.member)))...> parts{
            inspectable(x.*(each.member))...};
        return std::apply(
            [&](auto&... part) { return f(caf::meta::type_name(type_name), part...); }, parts);
      },
      fields_of(static_cast<const T*>(nullptr)));
}

} // namespace rubicon
