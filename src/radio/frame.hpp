// IEEE 802.15.4 data and ack frames as TinyOS sends them on 2.4 GHz (docs/tinyos.md 4).
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/error.hpp"
#include "core/time.hpp"

namespace rubicon::radio {

/// Values of FCF bits 0-2. Beacons and commands do not occur.
enum class frame_type : std::uint8_t { data = 1, ack = 2 };

/// TinyOS's default group (docs/tinyos.md 4.3).
inline constexpr std::uint16_t default_pan = 0x22;

/// What a frame says. A view: `payload` belongs to somebody else, after decode() to the PSDU. An
/// ack says its type and DSN only; encode() ignores the other fields and decode() leaves their
/// defaults.
struct frame {
  frame_type type = frame_type::data;
  bool ack_request = false;
  std::uint8_t dsn = 0; ///< sequence number of the sender; an ack repeats it
  std::uint16_t pan = default_pan;
  mote_id destination = broadcast_mote;
  mote_id source;
  std::uint8_t am_type = 0;
  byte_view payload; ///< 0..payload_max octets
};

inline constexpr std::size_t psdu_max = 127;             ///< FCS included, NET-14
inline constexpr std::size_t header_size = 11;           ///< FCF to AM type (docs/tinyos.md 4.1)
inline constexpr std::size_t overhead = header_size + 2; ///< and the FCS
inline constexpr std::size_t payload_max = psdu_max - overhead;
inline constexpr std::size_t ack_size = 5; ///< PSDU of an ack

/// The FCS over FCF..payload; it follows them low octet first (docs/tinyos.md 4.1).
[[nodiscard]] std::uint16_t fcs(byte_view octets);

/// The PSDU: what follows the length octet on the air, FCS included.
/// @pre x.payload.size() <= payload_max
[[nodiscard]] bytes encode(const frame& x);

/// Reads a PSDU strictly. Fails with truncated or too_long (no PSDU of this kind has that length),
/// bad_checksum, or unsupported (well-formed, but not one of the layouts of docs/tinyos.md 4.1:
/// beacon, command, security, other address modes, no network octet 0x3f).
/// @returns a frame whose payload views `psdu`
[[nodiscard]] result<frame> decode(byte_view psdu);

/// From the begin of a frame on the air to the end of its start-of-frame delimiter: the moment that
/// sender and receivers all observe (docs/tinyos.md 4.1).
inline constexpr duration sfd_delay = 32us * 5;

/// How long a frame occupies the air: 32 us an octet, 6 octets of preamble, SFD and length before
/// the PSDU (docs/tinyos.md 4.1). A PSDU of 100 octets takes 3392 us (NET-15).
[[nodiscard]] constexpr duration air_time(std::size_t psdu_size) {
  return 32us * static_cast<duration::rep>(6 + psdu_size);
}

} // namespace rubicon::radio
