// How a failure that comes from outside is reported: a value, never an exception.
#pragma once

#include <cassert>
#include <cstdint>
#include <string_view>
#include <utility>
#include <variant>

namespace rubicon {

/// Why octets, an address or a request from outside were refused.
enum class errc : std::uint8_t {
  truncated,    ///< fewer octets than the layout needs
  too_long,     ///< more octets than the layout or a limit allows
  bad_checksum, ///< CRC or MAC does not match
  bad_value,    ///< a field has a value its layout forbids
  unsupported,  ///< well-formed, but of a kind or version we do not speak
};

[[nodiscard]] std::string_view to_string(errc x);

/// A value, or why there is none.
template <class T>
class [[nodiscard]] result {
public:
  result(T value) : content_(std::move(value)) {} // NOLINT: implicit, so that decoders can return
  result(errc error) : content_(error) {}         // NOLINT

  explicit operator bool() const { return std::holds_alternative<T>(content_); }

  /// @pre holds a value
  const T& operator*() const& { return std::get<T>(content_); }
  T& operator*() & { return std::get<T>(content_); }
  T&& operator*() && { return std::get<T>(std::move(content_)); }
  const T* operator->() const { return &std::get<T>(content_); }
  T* operator->() { return &std::get<T>(content_); }

  /// @pre holds no value
  [[nodiscard]] errc error() const { return std::get<errc>(content_); }

private:
  std::variant<T, errc> content_;
};

} // namespace rubicon
