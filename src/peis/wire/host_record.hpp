// Who a peer is and where it can be reached (docs/peis-wire.md 5 and 6, KH-03).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/error.hpp"

namespace rubicon::peis {

inline constexpr std::size_t host_record_size = 544;
inline constexpr std::size_t host_record_message_size = 552;
inline constexpr std::size_t low_level_addresses_max = 16;
/// In the flags word of records of our own kind; G6 kernels neither read nor change it.
inline constexpr std::uint32_t liveness_mark = 0x52424e31;

/// One interface of a peer.
struct low_level_address {
  enum class kind : std::uint32_t {
    tcp_ipv4 = 0,
    udp_ipv4 = 1,
    tcp_ipv6 = 2,
    bluetooth = 3,
    inproc = 82, ///< ours: process 4, peer id 4; unknown to real kernels, which pass over it
  };

  std::string device; ///< up to 8 characters
  bool loopback = false;
  kind type = kind::tcp_ipv4;
  /// TCP and UDP: address 4, port 4; Bluetooth: address 6, port 2; ports in network byte order.
  std::array<std::uint8_t, 8> address{};

  friend bool operator==(const low_level_address&, const low_level_address&) = default;
};

struct host_record {
  peer_id id;
  std::int32_t magic = 0; ///< distinguishes two incarnations of an id
  std::string host_name;  ///< up to 63 characters; equal names mean the same machine
  std::string full_name;  ///< program@host!process, up to 63 characters
  std::vector<low_level_address> addresses; ///< up to 16
  std::int32_t cluster = 0;                 ///< lowest id that the peer can reach
  bool marked = false;                      ///< carries the liveness mark: one of our kind

  friend bool operator==(const host_record&, const host_record&) = default;
};

/// Appends 544 octets. @pre at most 16 addresses
void encode(const host_record& record, bytes& out);

/// Decodes the first 544 octets: truncated; too_long for more than 16 addresses; bad_value for an
/// id below 1 or a name without NUL.
[[nodiscard]] result<host_record> decode_host_record(byte_view octets);

/// Takes in-process addresses, of which another process can make nothing, out of an encoded record.
/// @param octets an encoded host record, or a message that begins with one; shorter: left as it is
void hide_inproc(std::span<std::uint8_t> octets);

/// The message of port 13.
struct host_record_message {
  host_record record;
  bool cached = false; ///< false only when the sender describes itself
};

/// 552 octets.
[[nodiscard]] bytes encode(const host_record_message& message);

[[nodiscard]] result<host_record_message> decode_host_record_message(byte_view octets);

} // namespace rubicon::peis
