// The arithmetic of suite 1: AES-128 in counter mode (NIST SP 800-38A 6.5), and CMAC (RFC 4493) cut
// to its first 8 octets; SHA-256 where keys are agreed on. OpenSSL's libcrypto computes it.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "core/bytes.hpp"
#include "smepp/crypto/key.hpp"

namespace rubicon::smepp {

/// Which ciphers secure a frame: the first octet of each. Another cipher gets another number; a
/// receiver takes exactly those it was built for, so it cannot be downgraded to a weaker one.
enum class suite : std::uint8_t { aes_ctr_cmac64 = 1 };

using block = std::array<std::uint8_t, 16>;
using tag = std::array<std::uint8_t, 8>;

/// Encrypts or decrypts in place; `first` is the first counter block, a big-endian number that each
/// block counts up. @pre no counter block is used twice under one key
void apply_ctr(const key& under, const block& first, std::span<std::uint8_t> octets);

[[nodiscard]] block cmac(const key& under, byte_view octets);

/// The first 8 octets of cmac(): one guess in 2^64 is right.
[[nodiscard]] tag short_mac(const key& under, byte_view octets);

/// Takes the same time wherever they differ.
[[nodiscard]] bool is_same(const tag& a, const tag& b);

/// A key for one purpose, by CMAC as pseudorandom function in counter mode (NIST SP 800-108r1 4.1;
/// one step gives all 128 bits): CMAC(from, 01 | label | 00 | context | 0080).
[[nodiscard]] key derive(const key& from, std::string_view label, byte_view context = {});

/// A key from a secret that is no key yet: HKDF-SHA-256 without salt (RFC 5869).
[[nodiscard]] key hkdf(byte_view secret, std::string_view label);

/// The first 8 octets of SHA-256: to find another input of that hash takes 2^64 tries.
[[nodiscard]] tag short_hash(byte_view octets);

} // namespace rubicon::smepp
