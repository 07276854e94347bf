// The time that the members of a group share (SMP-16, SMP-26).
#pragma once

#include <chrono>
#include <cstdint>

#include "core/codec.hpp"

namespace rubicon::smepp {

/// Microseconds since its first member created the group; 48 bits of them travel: 8.9 years.
struct group_clock {
  using duration = std::chrono::microseconds;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<group_clock>;
  static constexpr bool is_steady = true;
};
using group_time = group_clock::time_point;

inline constexpr group_time group_time_max{std::chrono::microseconds{(std::int64_t{1} << 48) - 1}};

/// @pre 0 <= x <= group_time_max
inline void write(byte_writer& to, group_time x) {
  const auto us = static_cast<std::uint64_t>(x.time_since_epoch().count());
  to.big(static_cast<std::uint16_t>(us >> 32)).big(static_cast<std::uint32_t>(us));
}

[[nodiscard]] inline group_time read_group_time(byte_reader& from) {
  const auto high = std::uint64_t{from.big<std::uint16_t>()};
  const auto low = std::uint64_t{from.big<std::uint32_t>()};
  return group_time(std::chrono::microseconds(static_cast<std::int64_t>(high << 32 | low)));
}

} // namespace rubicon::smepp
