// What the two ends of a synaptic channel say to each other over it (SYN-12, SYN-15): one octet of
// kind first, network byte order. The kinds are none of a stream's (stream/message.hpp), so that
// who accepts a channel recognises its user by its first packet.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <variant>
#include <vector>

#include "core/bytes.hpp"
#include "core/error.hpp"

namespace rubicon::synaptic {

/// 0x11, SYN_OPEN: from the out end; repeated until it is answered.
struct open_message {
  std::uint8_t size = 1;    ///< elements of the vector, > 0
  std::uint8_t divisor = 1; ///< a vector every so many ticks, > 0

  friend bool operator==(const open_message&, const open_message&) = default;
};

/// 0x12, SYN_OPEN_ACK: the application of the in end has created the same channel.
struct open_ack_message {
  friend bool operator==(const open_ack_message&, const open_ack_message&) = default;
};

/// 0x13, SYN_OPEN_NAK: it has created one of another size or divisor.
struct open_nak_message {
  friend bool operator==(const open_nak_message&, const open_nak_message&) = default;
};

/// 0x14, SYN_VECTOR: ChOut at a tick, or the part of it that fits into a packet.
struct vector_message {
  std::uint32_t tick = 0;    ///< T
  std::uint8_t first = 0;    ///< index of the first value
  std::vector<float> values; ///< at least one

  friend bool operator==(const vector_message&, const vector_message&) = default;
};

/// 0x15, SYN_STOP: from the out end; repeated until it is acknowledged.
struct stop_message {
  std::uint32_t tick = 0; ///< of the last vector

  friend bool operator==(const stop_message&, const stop_message&) = default;
};

/// 0x16, SYN_STOP_ACK.
struct stop_ack_message {
  std::uint32_t tick = 0; ///< of the SYN_STOP

  friend bool operator==(const stop_ack_message&, const stop_ack_message&) = default;
};

using message = std::variant<open_message, open_ack_message, open_nak_message, vector_message,
                             stop_message, stop_ack_message>;

/// Octets of SYN_VECTOR before the values, and of a value (binary32).
inline constexpr std::size_t vector_header_size = 6;
inline constexpr std::size_t value_size = 4;

/// Whether a channel whose first packet this is belongs to us.
[[nodiscard]] constexpr bool is_synaptic(byte_view octets) {
  return !octets.empty() && octets[0] >= 0x11 && octets[0] <= 0x16;
}

[[nodiscard]] bytes encode(const message& x);

/// The SYN_VECTORs of a whole vector, as few as there can be, none longer than `packet_max` octets.
/// @pre 0 < values.size() <= 255, and a packet holds a value
[[nodiscard]] std::vector<bytes> encode_vector(std::uint32_t tick, std::span<const float> values,
                                               std::size_t packet_max);

/// Octets of each of them. @pre as there
[[nodiscard]] std::vector<std::size_t> vector_packets(std::size_t elements, std::size_t packet_max);

/// Errors: truncated, too_long, bad_value (size or divisor 0), unsupported (unknown kind). Whether
/// the channel has such indices the in end knows.
[[nodiscard]] result<message> decode_message(byte_view octets);

} // namespace rubicon::synaptic
