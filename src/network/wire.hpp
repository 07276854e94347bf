// What the frames of the Network module have in common.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

#include "core/codec.hpp"
#include "core/island_time.hpp"

namespace rubicon::network {

/// Octets that fit the payload of a radio frame beside its headers (NET-14).
inline constexpr std::size_t frame_payload_max = 114;

/// Serial number arithmetic (RFC 1982) on 16 bits.
[[nodiscard]] constexpr bool is_newer(std::uint16_t a, std::uint16_t b) {
  return static_cast<std::int16_t>(static_cast<std::uint16_t>(a - b)) > 0;
}

/// The low 48 bits of its microseconds.
inline void write(byte_writer& to, island_time x) {
  const auto us = static_cast<std::uint64_t>(x.time_since_epoch().count());
  to.big(static_cast<std::uint16_t>(us >> 32)).big(static_cast<std::uint32_t>(us));
}

[[nodiscard]] inline island_time read_island_time(byte_reader& from) {
  const auto high = std::uint64_t{from.big<std::uint16_t>()};
  const auto low = std::uint64_t{from.big<std::uint32_t>()};
  return island_time(std::chrono::microseconds(static_cast<std::int64_t>(high << 32 | low)));
}

} // namespace rubicon::network
