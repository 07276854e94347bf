// HDLC-like frames of the TinyOS serial stack (tinyos.md 1.1; A-50).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/bytes.hpp"
#include "core/describe/fields.hpp"

namespace rubicon::serial {

inline constexpr std::uint8_t flag_octet = 0x7e;   ///< opens and closes a frame
inline constexpr std::uint8_t escape_octet = 0x7d; ///< the next octet is XORed with escape_mask
inline constexpr std::uint8_t escape_mask = 0x20;

/// Most octets that a mote takes after type and sequence number, CRC included.
inline constexpr std::size_t mote_body_max = 254;

/// Longest packet, dispatch octet included, that a mote takes.
inline constexpr std::size_t packet_octets_max = mote_body_max - 2;

/// Most octets between two flags, after removal of escapes, that a PC takes.
inline constexpr std::size_t frame_octets_max = 256;

enum class frame_type : std::uint8_t {
  ack = 0x43,
  packet_with_ack = 0x44, ///< a packet whose receiver must answer with an ack
  packet = 0x45,          ///< a packet without ack
  unknown = 0xff,         ///< answer to a frame of unknown type
};

/// Which frames have a sequence number on the wire.
[[nodiscard]] constexpr bool has_sequence(frame_type x) {
  return x == frame_type::ack || x == frame_type::packet_with_ack;
}

/// What stands between two flags, without the CRC.
struct frame {
  frame_type type = frame_type::packet;
  std::uint8_t sequence = 0; ///< of ack and packet_with_ack; otherwise 0 and not on the wire
  bytes packet;              ///< dispatch octet first; of `unknown` the refused type; of ack empty

  friend bool operator==(const frame&, const frame&) = default;
};

/// CRC-16/XMODEM: polynomial 0x1021, most significant bit first; `123456789` gives 0x31c3.
/// @param start the CRC of the octets before these
[[nodiscard]] std::uint16_t crc16(byte_view octets, std::uint16_t start = 0);

/// All octets on the wire, both flags included. @pre an ack has no packet
[[nodiscard]] bytes encode(const frame& x);

struct frame_counters {
  std::uint64_t good = 0;
  std::uint64_t bad_crc = 0;
  std::uint64_t too_short = 0;    ///< one to three octets between flags; none is idle line
  std::uint64_t too_long = 0;     ///< more than frame_octets_max between flags
  std::uint64_t aborted = 0;      ///< escape followed by flag
  std::uint64_t unknown_type = 0; ///< good CRC, but none of frame_type
  std::uint64_t malformed = 0;    ///< good CRC, but an ack that carries more than its sequence
};
RUBICON_FIELDS(frame_counters, good, bad_crc, too_short, too_long, aborted, unknown_type,
               malformed);

/// The receiver of a PC: accepts one flag between two frames, keeps its place after a bad CRC, and
/// looks for the next flag after an aborted or overlong frame (tinyos.md 1.1, 1.4).
class frame_decoder {
public:
  /// @returns the frame that this octet completes
  [[nodiscard]] std::optional<frame> on_octet(std::uint8_t octet);

  [[nodiscard]] const frame_counters& counters() const { return counters_; }

private:
  [[nodiscard]] std::optional<frame> on_flag();
  [[nodiscard]] std::optional<frame> parse(byte_view content);
  void lose_place();

  bytes content_; ///< since the last flag, escapes removed
  bool in_frame_ = false;
  bool escaped_ = false;
  frame_counters counters_;
};

} // namespace rubicon::serial
