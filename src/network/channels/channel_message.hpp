// What one mote of a channel's path says to the next: the payload of frames of AM type am::channel,
// network byte order, one octet of kind first, then the channel id (uint16 source, uint16 number).
#pragma once

#include <chrono>
#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/describe/fields.hpp"
#include "core/error.hpp"
#include "core/island_time.hpp"
#include "network/places/coordinates.hpp"
#include "network/wire.hpp"

namespace rubicon::network {

/// Unique in its island (NET-01): the mote that has opened the channel, and a number of its own.
struct channel_id {
  mote_id source;
  std::uint16_t number = 0;

  friend constexpr auto operator<=>(const channel_id&, const channel_id&) = default;
};
RUBICON_FIELDS(channel_id, source, number);

[[nodiscard]] std::string to_string(channel_id x);

/// The same as one number, and back.
[[nodiscard]] constexpr std::uint32_t number_of(channel_id x) {
  return static_cast<std::uint32_t>(x.source.value) << 16U | x.number;
}
[[nodiscard]] constexpr channel_id channel_of(std::uint32_t number) {
  return {mote_id(static_cast<std::uint16_t>(number >> 16U)),
          static_cast<std::uint16_t>(number & 0xffffU)};
}

/// When packets are to come, for the radios on the path (NRG-01).
struct channel_schedule {
  island_time first;                     ///< when the source sends the first
  std::chrono::milliseconds interval{0}; ///< 0: at any time
  std::uint8_t size = 0;                 ///< octets of a packet

  friend bool operator==(const channel_schedule&, const channel_schedule&) = default;
};

/// Why a channel is not, or no longer, there.
enum class channel_end : std::uint8_t {
  no_room = 1,     ///< a table on the path is full
  unreachable = 2, ///< no mote knows a route, or the destination did not answer
  disconnected = 3,
  broken = 4,  ///< a mote on the path is gone
  expired = 5, ///< nothing came over it for too long
};

[[nodiscard]] std::string to_string(channel_end x);

/// 1: towards the destination, reserving at each mote (NET-02). 25 octets.
struct connect_message {
  mote_id destination;
  std::optional<virtual_coordinates> place; ///< of the destination; nothing: look for it everywhere
  bool flooded = false;                     ///< to all, since greedy forwarding has ended
  std::uint8_t hops = 0;                    ///< made
  std::uint16_t expiry_s = 0;               ///< without packets the channel ends; 0: never (NET-08)
  channel_schedule schedule;
  std::uint32_t delay_us = 0; ///< a packet's expected delay from the source to this mote (NRG-03)

  friend bool operator==(const connect_message&, const connect_message&) = default;
};

/// 2: back to the source: the channel is open (NET-03).
struct connect_ack_message {
  std::uint8_t hops = 0; ///< of the whole path

  friend bool operator==(const connect_ack_message&, const connect_ack_message&) = default;
};

/// 3: in either direction: the channel is no more, free what is reserved (NET-04, NET-07, NET-09).
struct end_message {
  channel_end why = channel_end::disconnected;

  friend bool operator==(const end_message&, const end_message&) = default;
};

/// 4: to the previous mote: no neighbour of ours is nearer.
struct dead_end_message {
  friend bool operator==(const dead_end_message&, const dead_end_message&) = default;
};

/// 5: a packet (NET-05).
struct data_message {
  std::uint8_t sequence = 0; ///< by the sending end; distinguishes a packet from the one before
  bytes content;

  friend bool operator==(const data_message&, const data_message&) = default;
};

struct channel_message {
  channel_id channel;
  std::variant<connect_message, connect_ack_message, end_message, dead_end_message, data_message>
      content;

  friend bool operator==(const channel_message&, const channel_message&) = default;
};

inline constexpr std::size_t channel_header_size = 5;

/// The longest packet: what a radio frame holds beside header and sequence number.
inline constexpr std::size_t channel_packet_max = frame_payload_max - channel_header_size - 1;

[[nodiscard]] bytes encode(const channel_message& x);

/// Errors: truncated, too_long (octets after the message), bad_value, unsupported (unknown kind).
[[nodiscard]] result<channel_message> decode_channel_message(byte_view octets);

} // namespace rubicon::network
