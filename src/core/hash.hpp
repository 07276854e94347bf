// A 64-bit fold with the same result on every machine: seeds of random streams and trace hashes.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

#include "core/bytes.hpp"

namespace rubicon {

/// Folds values into 64 bits, order-sensitive. Not cryptographic.
class fold64 {
public:
  constexpr fold64() = default;
  constexpr explicit fold64(std::uint64_t start) : state_(start) {}

  constexpr fold64& add(std::uint64_t x) {
    state_ = (state_ ^ x) * 0x9e3779b97f4a7c15ULL;
    state_ ^= state_ >> 29;
    return *this;
  }

  constexpr fold64& add(std::string_view x) {
    add(x.size());
    const auto* at = x.data();
    auto left = x.size();
    for (; left >= 8; left -= 8, at += 8)
      add(word_at({at, 8}));
    if (left > 0 && x.size() >= 8) // the rest is the end of a word that is there
      add(word_at({at + left - 8, 8}) >> (8 * (8 - left)));
    else if (left > 0)
      add(word_at({at, left}));
    return *this;
  }

  fold64& add(byte_view x) {
    return add(std::string_view(reinterpret_cast<const char*>(x.data()), x.size()));
  }

  [[nodiscard]] constexpr std::uint64_t value() const { return state_; }

private:
  /// Up to eight octets, the first in the lowest bits, whatever the machine's byte order.
  [[nodiscard]] static constexpr std::uint64_t word_at(std::string_view x) {
    std::uint64_t word = 0;
    if (!std::is_constant_evaluated() && std::endian::native == std::endian::little &&
        x.size() == 8) {
      std::memcpy(&word, x.data(), 8);
      return word;
    }
    for (std::size_t i = 0; i < x.size(); ++i)
      word |= static_cast<std::uint64_t>(static_cast<unsigned char>(x[i])) << (8 * i);
    return word;
  }

  std::uint64_t state_ = 0x6a09e667f3bcc908ULL;
};

/// @returns 16 lower-case hexadecimal digits
[[nodiscard]] std::string to_hex(std::uint64_t x);

} // namespace rubicon
