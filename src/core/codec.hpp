// Field by field encoding and decoding: no structure is ever cast onto octets.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>

#include "core/bytes.hpp"

namespace rubicon {

/// Reads fields from octets. Reading past the end yields zeros and makes ok() false for good, so a
/// decoder reads all its fields and checks once.
class byte_reader {
public:
  explicit byte_reader(byte_view octets) : octets_(octets) {}

  /// Network byte order.
  template <std::integral T>
  [[nodiscard]] T big() {
    std::make_unsigned_t<T> value = 0;
    for (const auto octet : take(sizeof(T)))
      value = static_cast<std::make_unsigned_t<T>>(static_cast<std::uint64_t>(value) << 8 | octet);
    return static_cast<T>(value);
  }

  template <std::integral T>
  [[nodiscard]] T little() {
    std::uint64_t value = 0;
    unsigned shift = 0;
    for (const auto octet : take(sizeof(T))) {
      value |= static_cast<std::uint64_t>(octet) << shift;
      shift += 8;
    }
    return static_cast<T>(value);
  }

  [[nodiscard]] std::uint8_t octet() { return big<std::uint8_t>(); }

  /// The next `count` octets, still owned by the source; empty when there are fewer.
  [[nodiscard]] byte_view take(std::size_t count) {
    if (!ok_ || count > octets_.size()) {
      ok_ = false;
      return {};
    }
    const auto head = octets_.first(count);
    octets_ = octets_.subspan(count);
    return head;
  }

  void skip(std::size_t count) { static_cast<void>(take(count)); }

  [[nodiscard]] byte_view rest() { return take(octets_.size()); }

  /// A fixed field of `size` octets holding NUL-terminated text; without a NUL ok() becomes false.
  [[nodiscard]] std::string fixed_text(std::size_t size) {
    const auto field = take(size);
    const std::string_view text(reinterpret_cast<const char*>(field.data()), field.size());
    const auto end = text.find('\0');
    if (end == std::string_view::npos) {
      ok_ = false;
      return {};
    }
    return std::string(text.substr(0, end));
  }

  [[nodiscard]] bool ok() const { return ok_; }
  [[nodiscard]] std::size_t remaining() const { return octets_.size(); }

private:
  byte_view octets_;
  bool ok_ = true;
};

/// Appends fields to octets it owns.
class byte_writer {
public:
  byte_writer() = default;
  /// For so many octets, or a few more than will be written: memory is taken once, not at each
  /// doubling.
  explicit byte_writer(std::size_t expected) { octets_.reserve(expected); }

  /// Network byte order.
  template <std::integral T>
  byte_writer& big(T value) {
    for (std::size_t i = sizeof(T); i-- > 0;)
      octets_.push_back(static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8 * i)));
    return *this;
  }

  template <std::integral T>
  byte_writer& little(T value) {
    for (std::size_t i = 0; i < sizeof(T); ++i)
      octets_.push_back(static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8 * i)));
    return *this;
  }

  byte_writer& octet(std::uint8_t value) {
    octets_.push_back(value);
    return *this;
  }

  byte_writer& append(byte_view octets) {
    octets_.insert(octets_.end(), octets.begin(), octets.end());
    return *this;
  }

  byte_writer& zeros(std::size_t count) {
    octets_.insert(octets_.end(), count, std::uint8_t{0});
    return *this;
  }

  /// Text in a fixed field of `size` octets, cut to leave at least one NUL, filled with NULs.
  byte_writer& fixed_text(std::string_view text, std::size_t size) {
    const auto shown = text.substr(0, size - 1);
    octets_.insert(octets_.end(), shown.begin(), shown.end());
    return zeros(size - shown.size());
  }

  [[nodiscard]] std::size_t size() const { return octets_.size(); }
  [[nodiscard]] byte_view view() const { return octets_; }
  [[nodiscard]] bytes finish() { return std::move(octets_); }

private:
  bytes octets_;
};

} // namespace rubicon
