// Fixed layouts: fields at the offsets that the wire format's tables give (peis-wire.md 1).
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <type_traits>

#include "core/bytes.hpp"

namespace rubicon::peis {

/// Writes the fields of a structure of N octets; what is not written stays zero.
template <std::size_t N>
class layout_writer {
public:
  /// Network byte order.
  template <std::integral T>
  layout_writer& big(std::size_t offset, T value) {
    assert(offset + sizeof(T) <= N);
    for (std::size_t i = 0; i < sizeof(T); ++i)
      octets_[offset + i] = static_cast<std::uint8_t>(static_cast<std::make_unsigned_t<T>>(value) >>
                                                      (8 * (sizeof(T) - 1 - i)));
    return *this;
  }

  layout_writer& octet(std::size_t offset, std::uint8_t value) {
    octets_.at(offset) = value;
    return *this;
  }

  layout_writer& copy(std::size_t offset, byte_view octets) {
    assert(offset + octets.size() <= N);
    std::copy(octets.begin(), octets.end(), octets_.begin() + static_cast<std::ptrdiff_t>(offset));
    return *this;
  }

  /// Text in a field of `size` octets, cut to leave at least one NUL.
  layout_writer& text(std::size_t offset, std::size_t size, std::string_view value) {
    const auto shown = value.substr(0, size - 1);
    return copy(offset, {reinterpret_cast<const std::uint8_t*>(shown.data()), shown.size()});
  }

  [[nodiscard]] byte_view view() const { return octets_; }
  void append_to(bytes& out) const { out.insert(out.end(), octets_.begin(), octets_.end()); }

private:
  std::array<std::uint8_t, N> octets_{};
};

/// Reads the fields of a structure. @pre each field lies inside the octets
class layout_reader {
public:
  explicit layout_reader(byte_view octets) : octets_(octets) {}

  /// Network byte order.
  template <std::integral T>
  [[nodiscard]] T big(std::size_t offset) const {
    assert(offset + sizeof(T) <= octets_.size());
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i)
      value = value << 8 | octets_[offset + i];
    return static_cast<T>(value);
  }

  [[nodiscard]] std::uint8_t octet(std::size_t offset) const { return big<std::uint8_t>(offset); }

  /// The text before the first NUL of a field; nothing if there is no NUL.
  [[nodiscard]] std::optional<std::string_view> text(std::size_t offset, std::size_t size) const {
    const auto field = octets_.subspan(offset, size);
    const auto end = std::find(field.begin(), field.end(), std::uint8_t{0});
    if (end == field.end())
      return std::nullopt;
    return std::string_view(reinterpret_cast<const char*>(field.data()),
                            static_cast<std::size_t>(end - field.begin()));
  }

private:
  byte_view octets_;
};

} // namespace rubicon::peis
