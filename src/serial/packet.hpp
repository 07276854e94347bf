// The serial active message: what a packet with dispatch 0 holds (docs/tinyos.md 1.2).
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/bytes.hpp"
#include "core/error.hpp"

namespace rubicon::serial {

inline constexpr std::uint8_t am_dispatch = 0;     ///< first octet of a serial active message
inline constexpr std::size_t am_header_octets = 7; ///< after the dispatch octet
inline constexpr std::size_t am_payload_max = 114; ///< what fits one radio frame
inline constexpr std::uint8_t default_group = 0x22;
inline constexpr std::uint16_t am_broadcast = 0xffff;

/// All fields travel in network byte order.
struct am_packet {
  std::uint16_t destination = am_broadcast;
  std::uint16_t source = 0; ///< 0 when a PC sends
  std::uint8_t group = default_group;
  std::uint8_t am_type = 0;
  bytes payload; ///< 0..am_payload_max octets

  friend bool operator==(const am_packet&, const am_packet&) = default;
};

/// Dispatch octet, header and payload. @pre x.payload.size() <= am_payload_max
[[nodiscard]] bytes encode(const am_packet& x);

/// The opposite of encode(). The length field must be that of the octets, unlike on a mote, which
/// believes it (docs/tinyos.md 1.4).
/// Errors: truncated (no complete header, or less payload than the length field says), too_long
/// (more payload than that, or a length field above am_payload_max), unsupported (not dispatch 0).
[[nodiscard]] result<am_packet> decode_am_packet(byte_view packet);

} // namespace rubicon::serial
