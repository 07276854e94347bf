// What Transport adds in front of a user's payload (A-51, WIR-04).
#pragma once

#include <cstdint>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/error.hpp"

namespace rubicon::transport {

/// A user payload with its 6-octet header: uint16 source mote, uint16 sequence, uint8 AM type,
/// uint8 flags (bit 0 reliable, bit 1 acknowledgement); network byte order.
struct segment {
  mote_id source;
  std::uint16_t sequence = 0;
  std::uint8_t am_type = 0;
  bool reliable = false;
  bool acknowledgement = false; ///< of the segment with this sequence number; then without payload
  bytes payload;

  friend bool operator==(const segment&, const segment&) = default;
};

inline constexpr std::size_t header_size = 6;

/// Octets that fit one radio frame beside the 5.4 header and the transport header: 114 - 8 - 6.
inline constexpr std::size_t payload_max = 100;

[[nodiscard]] bytes encode(const segment& x);

/// Errors: truncated, too_long (payload above payload_max), bad_value (unknown flags, or an
/// acknowledgement that carries a payload or asks for one itself).
[[nodiscard]] result<segment> decode_segment(byte_view octets);

} // namespace rubicon::transport
