// Numbers that cannot be guessed without a secret: names of sessions, and cookies by which
// the other side proves its address without any memory of ours.
#pragma once

#include <array>
#include <cstdint>

#include "core/bytes.hpp"
#include "core/time.hpp"
#include "peis/udp/udp_datagram.hpp"

namespace rubicon::peis {

/// 128 bits, from a source that cannot be foreseen.
using udp_secret = std::array<std::uint64_t, 2>;

/// SipHash-2-4 (Aumasson and Bernstein 2012).
[[nodiscard]] std::uint64_t keyed_hash(const udp_secret& key, byte_view octets);

class udp_cookies {
public:
  /// A cookie is good for at least so long, and at most twice that.
  static constexpr duration age = 10s;

  udp_cookies() = default;
  explicit udp_cookies(udp_secret secret) : secret_(secret) {}

  /// Never the same, never 0.
  [[nodiscard]] udp_token next_token();

  /// For who asks from this address for a session of this name; never 0.
  [[nodiscard]] std::uint64_t cookie(const udp_address& from, udp_token token, instant now) const;
  [[nodiscard]] bool is_good(std::uint64_t cookie, const udp_address& from, udp_token token,
                             instant now) const;

private:
  [[nodiscard]] std::uint64_t of_age(const udp_address& from, udp_token token,
                                     std::int64_t number) const;

  udp_secret secret_{};
  std::uint64_t tokens_ = 0;
};

} // namespace rubicon::peis
