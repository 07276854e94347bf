// A secret of 128 bits that cannot be printed by mistake.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/bytes.hpp"

namespace rubicon::smepp {

/// A key of AES-128. It has no to_string, no stream operator and no inspect: what holds one cannot
/// be logged, traced, reported or sent by an actor's message. Its octets are wiped when it ends.
class key {
public:
  static constexpr std::size_t size = 16;

  key() = default; ///< zeros: no secret at all
  explicit key(const std::array<std::uint8_t, size>& octets) : octets_(octets) {}
  key(const key&) = default;
  key& operator=(const key&) = default;
  ~key();

  /// @param hex 32 hexadecimal digits; nothing for all else
  [[nodiscard]] static std::optional<key> from_hex(std::string_view hex);

  /// The octets, for ciphers and the store that outlasts a loss of power alone.
  [[nodiscard]] byte_view reveal() const { return octets_; }

  /// Four hexadecimal digits by which people distinguish keys: 16 bits of a MAC under the key.
  [[nodiscard]] std::string fingerprint() const;

  /// Takes the same time wherever they differ.
  friend bool operator==(const key& a, const key& b);

private:
  std::array<std::uint8_t, size> octets_{};
};

/// One key encrypts, the other one authenticates (D1.1 3.4.2).
struct key_pair {
  key confidentiality;
  key integrity;

  friend bool operator==(const key_pair&, const key_pair&) = default;
};

} // namespace rubicon::smepp
