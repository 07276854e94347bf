// What the two ends of a tunnel say to each other: the body of packets of channel tunnel_channel,
// network byte order.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/error.hpp"

namespace rubicon::transport {

/// Of the packets that carry tunnels: above 255, so for streams and synaptic traffic (WIR-01).
inline constexpr std::uint16_t tunnel_channel = 256;

/// Which start of a node this is, as tunnels send it: 1..tunnel_lives in turn; 0: not known yet.
using tunnel_life = std::uint8_t;

inline constexpr tunnel_life tunnel_lives = 15;

/// 8 octets, then the content: uint8 (high bit: from the acceptor; kind), uint16 sender, uint16
/// receiver, uint16 number, uint8 (opener's life in the high 4 bits, acceptor's in the low 4).
///
/// Number and lives name the tunnel, together with the addresses of its ends and who has opened it.
struct tunnel_message {
  enum class kind : std::uint8_t {
    connect = 1, ///< from the opener, which does not know the acceptor's life
    accept = 2,  ///< from the acceptor
    refuse = 3,  ///< from the acceptor: not wanted, or no room
    data = 4,
    keep_alive = 5,
    close = 6, ///< the sender knows no such tunnel, or no longer
  };

  kind what = kind::connect;
  bool from_acceptor = false;
  mote_id sender;           ///< no_mote: a PC
  mote_id receiver;         ///< no_mote: a PC
  std::uint16_t number = 0; ///< the opener's
  tunnel_life opener = 1;
  tunnel_life acceptor = 0; ///< 0 in connect, and in the close of an opener that was not answered
  bytes content{};          ///< empty but for data

  friend bool operator==(const tunnel_message&, const tunnel_message&) = default;
};

inline constexpr std::size_t tunnel_header_size = 8;

/// What a packet's body holds beside the header (WIR-03, WIR-04).
inline constexpr std::size_t tunnel_content_max = 256 + 6 - tunnel_header_size;

/// @pre what is said at the fields
[[nodiscard]] bytes encode(const tunnel_message& x);

/// Errors: truncated, too_long (content above tunnel_content_max), unsupported (unknown kind),
/// bad_value (a kind from the wrong end, a life that cannot be, a sender that is no node, content
/// where there is none).
[[nodiscard]] result<tunnel_message> decode_tunnel_message(byte_view octets);

} // namespace rubicon::transport
