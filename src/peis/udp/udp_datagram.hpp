// What two peers of ours send each other over UDP (D1.1 3.1.5.2, UDP-01). A G6 kernel has no
// working UDP (docs/peis-wire.md 3.1), so this form is our own.
//
//   handshake, 24 octets:  sync 4, kind 1, zero 1, room 2, token 8, cookie 8
//   segment, 48 or more:   sync 4, kind 1, zero 1, room 2, token 8, sequence 8, expected 8, number
//   4,
//                          newest 4, count 4, credit 2, zero 2, content
// All numbers are in network byte order.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <string>
#include <variant>

#include "core/bytes.hpp"
#include "core/error.hpp"
#include "core/text/ipv4_network.hpp"

namespace rubicon::peis {

/// Fits the frames of Ethernet and Wi-Fi with 72 octets to spare for tunnels.
inline constexpr std::size_t udp_datagram_max = 1400;
inline constexpr std::size_t udp_handshake_size = 24;
inline constexpr std::size_t udp_segment_header = 48;
inline constexpr std::size_t udp_content_max = udp_datagram_max - udp_segment_header;

/// One end of a session.
struct udp_address {
  ipv4_address ip{};
  std::uint16_t port = 0;

  friend auto operator<=>(const udp_address&, const udp_address&) = default;
};

/// `127.0.0.1:8000`
[[nodiscard]] std::string to_string(const udp_address& x);

/// Names a session: drawn by who opens it, and unknown to anyone who is not on the path.
struct udp_token {
  std::uint64_t value = 0;

  friend auto operator<=>(udp_token, udp_token) = default;
};

struct udp_handshake {
  enum class step : std::uint8_t {
    hello = 1,  ///< a session is wanted; cookie is 0
    cookie = 2, ///< prove that you get what is sent to your address
    open = 3,   ///< the cookie comes back
    opened = 4, ///< the session is there
    gone = 5,   ///< there is no such session, or no more
  };

  step kind = step::hello;
  std::uint16_t room = 0; ///< datagrams that the sender's socket holds unread
  udp_token token;
  std::uint64_t cookie = 0;

  friend bool operator==(const udp_handshake&, const udp_handshake&) = default;
};

/// A part of a session's octets, or word of what has come, or both.
struct udp_segment {
  std::uint16_t room = 0; ///< as above
  udp_token token;
  std::uint64_t sequence = 0; ///< of the part, from 0 on; means nothing if number is 0
  std::uint64_t expected = 0; ///< all parts of the other side before this one have come
  std::uint32_t number = 0;   ///< of this transmission, from 1 on; 0: it carries no part
  std::uint32_t newest = 0;   ///< highest number that has come; 0: none
  std::uint32_t count = 0;    ///< of transmissions that have come: the measure of delivery (UDP-02)
  std::uint16_t credit = 0;   ///< parts from `expected` on for which there is room
  /// With a number the part, else a bit for each part behind `expected`, the first in the highest
  /// bit: it has come.
  byte_view content;
};

/// What a number stands for of which only the last 32 bits were sent: the one nearest to `near`.
[[nodiscard]] std::uint64_t widened(std::uint32_t x, std::uint64_t near);

/// 24 octets.
[[nodiscard]] bytes encode(const udp_handshake& x);

/// Appends up to udp_datagram_max octets. @pre the content has udp_content_max at most
void encode(const udp_segment& x, bytes& out);

using udp_datagram = std::variant<udp_handshake, udp_segment>;

/// The content of a segment is valid as long as the octets are. truncated; too_long; bad_value for
/// a wrong sync word or kind, or a part without octets.
[[nodiscard]] result<udp_datagram> decode_udp_datagram(byte_view octets);

} // namespace rubicon::peis
