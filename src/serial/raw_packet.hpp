// The raw IEEE 802.15.4 frame that a packet with dispatch 2 holds (docs/tinyos.md 1.2, 4.1).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "core/bytes.hpp"
#include "core/error.hpp"
#include "serial/packet.hpp"

namespace rubicon::serial {

inline constexpr std::uint8_t raw_dispatch = 2;      ///< first octet of such a packet
inline constexpr std::size_t raw_length_max = 127;   ///< of a frame, its FCS included
inline constexpr std::uint8_t tinyos_network = 0x3f; ///< first octet of what TinyOS's frames carry

/// The types 4 to 7 are reserved.
enum class raw_kind : std::uint8_t { beacon = 0, data = 1, ack = 2, command = 3 };

[[nodiscard]] std::string_view to_string(raw_kind x);

/// One end of a frame, as far as the frame names it.
struct raw_end {
  std::optional<std::uint16_t> pan;
  std::optional<std::uint64_t> address; ///< of 2 octets, or 8
  bool is_long = false;                 ///< it has 8

  friend bool operator==(const raw_end&, const raw_end&) = default;
};

/// All fields travel least significant octet first. The FCS stays at the base station.
struct raw_frame {
  raw_kind kind = raw_kind::data;
  bool is_secured = false; ///< then `body` begins with what says how
  bool is_pending = false;
  bool asks_ack = false;
  std::uint8_t sequence = 0;
  raw_end destination;
  raw_end source; ///< without a PAN of its own it has the destination's
  bytes body;

  friend bool operator==(const raw_frame&, const raw_frame&) = default;
};

/// Errors: truncated (no complete header, or fewer octets than the length octet says), too_long
/// (more than that, or a length above raw_length_max), bad_value (a reserved type or addressing
/// mode of an end, or a length below 5), unsupported (not dispatch 2).
[[nodiscard]] result<raw_frame> decode_raw_packet(byte_view packet);

/// Such a packet. @param frame from its frame control field on, without its FCS
/// @pre frame.size() <= raw_length_max - 2
[[nodiscard]] bytes wrap_raw(byte_view frame);

/// What TinyOS carries in it: nothing unless it is data between short addresses, not secured, and
/// begins with its network octet. The group is the low octet of the destination's PAN.
[[nodiscard]] std::optional<am_packet> am_packet_in(const raw_frame& x);

inline constexpr std::uint8_t cc1000_dispatch = 1; ///< frames of that radio: an AM header, payload

/// The active message in a packet of any of the three dispatches. Errors: those of
/// decode_am_packet() and decode_raw_packet(); unsupported also for frames that carry none.
[[nodiscard]] result<am_packet> decode_any_packet(byte_view packet);

/// A data frame as TinyOS sends it, without asking for an acknowledgement, for the PAN of x.group.
/// @pre x.payload.size() <= am_payload_max
[[nodiscard]] bytes encode_raw(const am_packet& x, std::uint8_t sequence);

} // namespace rubicon::serial
