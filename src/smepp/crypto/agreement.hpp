// A secret that two peers agree on while others listen: X25519 (RFC 7748), by libcrypto.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/time.hpp"
#include "smepp/crypto/key.hpp"
#include "smepp/crypto/randomness.hpp"

namespace rubicon::smepp {

/// What one side lets the other know.
using key_share = std::array<std::uint8_t, 32>;

/// What a mote of 8 bits and 8 MHz needs for each share() and agree() [estimate]; the radio is not
/// needed meanwhile.
inline constexpr duration agreement_time = 2s;

/// One side, for one handshake.
class agreement {
public:
  using secret = std::array<std::uint8_t, 32>;

  agreement() = default; ///< of no use yet
  explicit agreement(const secret& x) : secret_(x) {}
  [[nodiscard]] static agreement make(randomness& from);
  agreement(const agreement&) = default;
  agreement& operator=(const agreement&) = default;
  ~agreement();

  [[nodiscard]] key_share share() const;

  /// The octets, for the store that outlasts a loss of power alone.
  [[nodiscard]] const secret& reveal() const { return secret_; }

  /// The same at both sides, and known to no other: HKDF-SHA-256 (RFC 5869) of the shared
  /// secret. Nothing if `other` is no proper share.
  [[nodiscard]] std::optional<key> agree(const key_share& other) const;

  /// The 32 octets of RFC 7748 6.1 that the key is made of, for tests with its vectors.
  [[nodiscard]] std::optional<secret> shared_secret(const key_share& other) const;

private:
  secret secret_{};
};

} // namespace rubicon::smepp
