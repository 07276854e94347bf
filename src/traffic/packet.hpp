// What a measuring packet carries, behind TinyOS's network octet and AM type.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/error.hpp"
#include "core/time.hpp"
#include "traffic/flow_config.hpp"

namespace rubicon::traffic {

/// Octets of a frame's MAC payload that are no AM payload: network octet and AM type
/// (docs/tinyos.md 4.1).
inline constexpr std::size_t am_overhead = 2;

/// Octets of AM payload.
inline constexpr std::size_t packet_min = payload_min - am_overhead;
inline constexpr std::size_t packet_max = payload_max - am_overhead;

inline constexpr std::uint64_t number_max = 0xffff'ffff'ffff;

/// On the air: uint16 origin, uint16 target, 48-bit number, uint64 nanoseconds since the start of
/// the run, zeros up to the size; network byte order.
struct packet {
  mote_id origin;
  mote_id target;                ///< broadcast_mote: all receivers
  std::uint64_t number = 0;      ///< 0..number_max, no two packets of an origin have the same
  instant requested;             ///< when the origin asked its MAC; not before the start of the run
  std::size_t size = packet_min; ///< octets of AM payload, packet_min..packet_max

  friend bool operator==(const packet&, const packet&) = default;
};

/// @pre number, requested and size are in their ranges
[[nodiscard]] bytes encode(const packet& x);

/// Errors: truncated, too_long, bad_value (an id that no mote has, a time that no clock shows,
/// padding that is not zero).
[[nodiscard]] result<packet> decode_packet(byte_view octets);

} // namespace rubicon::traffic
