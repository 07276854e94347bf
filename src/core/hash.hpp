// A 64-bit fold with the same result on every machine: seeds of random streams and trace hashes.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

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
    std::uint64_t word = 0;
    unsigned filled = 0;
    for (const char c : x) {
      word |= static_cast<std::uint64_t>(static_cast<unsigned char>(c)) << (8 * filled);
      if (++filled == 8) {
        add(word);
        word = 0;
        filled = 0;
      }
    }
    if (filled != 0)
      add(word);
    return *this;
  }

  fold64& add(byte_view x) {
    return add(std::string_view(reinterpret_cast<const char*>(x.data()), x.size()));
  }

  [[nodiscard]] constexpr std::uint64_t value() const { return state_; }

private:
  std::uint64_t state_ = 0x6a09e667f3bcc908ULL;
};

/// @returns 16 lower-case hexadecimal digits
[[nodiscard]] std::string to_hex(std::uint64_t x);

} // namespace rubicon
