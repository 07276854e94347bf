// What a beacon says about the clock of its island (CLK-01, CLK-03, CLK-08).
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/address.hpp"
#include "core/codec.hpp"
#include "core/island_time.hpp"

namespace rubicon::network {

/// How the time that peers share goes on, as seen from an island's.
struct network_line {
  island_clock::duration ahead{}; ///< network time since 1970 minus the island's, at some moment
  double rate = 0;                ///< by how much it goes faster, +-320 ppm

  friend bool operator==(const network_line&, const network_line&) = default;
};

/// What a beacon says about the island's clock: 28 octets, network byte order; 10 more if it has
/// the network time, as the highest bit of tick.from does then: ahead (8) and rate (2, in
/// hundredths of a ppm).
struct clock_stamp {
  mote_id root;
  std::uint8_t era = 0;       ///< the root's time has begun anew so often; wraps, and the next too
  std::uint16_t sequence = 0; ///< of the root's broadcast that this derives from
  island_time time;           ///< when the beacon was handed to the radio; 48 bits of microseconds
  /// From then to its start-of-frame delimiter on the air, microseconds: the radio writes it.
  std::uint32_t age_us = 0;
  tick_setting tick;           ///< its period below 2^13 milliseconds,
  std::uint8_t slots_used = 0; ///< whose three highest bits are time_estimate::slots_used()
  /// How far `time` may be wrong: 2^(x/8) microseconds, rounded up; 0: it is the root's own;
  /// doubt_asks: its sender asks those who know.
  std::uint8_t doubt = 0;
  /// At `time`; nothing: the root does not know it (CLK-08).
  std::optional<network_line> network = std::nullopt;

  friend bool operator==(const clock_stamp&, const clock_stamp&) = default;
};

inline constexpr std::size_t clock_stamp_size = 28;   ///< without the network time,
inline constexpr std::size_t network_line_size = 10;  ///< which comes last
inline constexpr std::size_t clock_stamp_age_at = 11; ///< where the age lies in it

/// @pre 0 <= x.tick.from < 2^47 microseconds, more than four years
void write(byte_writer& to, const clock_stamp& x);

/// What is missing reads as zeros; from.ok() shows it.
[[nodiscard]] clock_stamp read_clock_stamp(byte_reader& from);

inline constexpr std::uint8_t doubt_asks = 255;

/// As in clock_stamp::doubt, below doubt_asks.
[[nodiscard]] std::uint8_t doubt_of(std::chrono::microseconds x);
[[nodiscard]] std::chrono::microseconds limit_of(std::uint8_t doubt);

} // namespace rubicon::network
