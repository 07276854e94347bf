// What Transport adds in front of a user's payload (WIR-04).
#pragma once

#include <cstdint>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/error.hpp"

namespace rubicon::transport {

/// Which start of a node this is, as far as segments say it (DIS-07).
using incarnation = std::uint8_t;

inline constexpr incarnation sender_incarnations = 16;   ///< a sender's is sent modulo this,
inline constexpr incarnation receiver_incarnations = 32; ///< a receiver's modulo this
inline constexpr std::uint16_t counter_max = 0x0fff;

/// A user payload with its 6-octet header: uint16 source mote, uint16 (sender's incarnation in the
/// high 4 bits, counter), uint8 AM type, uint8 (receiver's incarnation in the high 5 bits, kind);
/// network byte order.
struct segment {
  enum class kind : std::uint8_t {
    plain = 0,           ///< no answer is expected; no incarnations
    reliable = 1,        ///< for this incarnation of the receiver only
    acknowledgement = 2, ///< of the reliable one with this counter, or of a hello
    no_program = 3,      ///< not taken, and never will be: no program here has this AM type
    hello = 5,           ///< who are you? From here on I count from this counter
    busy = 6,            ///< not taken: no room for this AM type now; ask again
    refused = 7,         ///< not taken: I am another incarnation, or do not know you
  };

  mote_id source;
  std::uint16_t counter = 0; ///< 12 bits; an answer repeats what it answers
  incarnation sender = 0;    ///< of the sender of the reliable one or hello; an answer repeats it
  std::uint8_t am_type = 0;
  kind what = kind::plain;
  incarnation receiver = 0; ///< of its receiver; an answer says its own sender's
  bytes payload;            ///< empty but for plain and reliable ones

  friend bool operator==(const segment&, const segment&) = default;
};

inline constexpr std::size_t header_size = 6;
inline constexpr std::size_t payload_max = 256; ///< MCK-09

/// @pre fields fit their bits
[[nodiscard]] bytes encode(const segment& x);

/// Errors: truncated, too_long (payload above payload_max), bad_value (unknown kind, or a payload
/// where there is none).
[[nodiscard]] result<segment> decode_segment(byte_view octets);

} // namespace rubicon::transport
