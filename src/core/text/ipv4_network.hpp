// IPv4 networks as files list them: `192.168.1.0/24`, or a single address.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/error.hpp"

namespace rubicon {

/// Octets a.b.c.d, first one first.
using ipv4_address = std::array<std::uint8_t, 4>;

struct ipv4_network {
  ipv4_address address{};
  std::uint8_t prefix = 32; ///< leading bits that count, at most 32; the others are 0

  [[nodiscard]] bool contains(const ipv4_address& x) const;

  friend bool operator==(const ipv4_network&, const ipv4_network&) = default;
};

/// `10.0.0.7`; bad_value if it is anything else.
[[nodiscard]] result<ipv4_address> parse_ipv4_address(std::string_view text);

/// `10.0.0.0/8` or `10.0.0.7`; bad_value if it is neither, or has bits behind the prefix.
[[nodiscard]] result<ipv4_network> parse_ipv4_network(std::string_view text);

[[nodiscard]] std::string to_string(const ipv4_network& x);

} // namespace rubicon
