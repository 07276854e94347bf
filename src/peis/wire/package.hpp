// The package: a header of 40 octets and up to 1024 octets of data (docs/peis-wire.md 6, P2P-06).
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/error.hpp"

namespace rubicon::peis {

inline constexpr std::size_t header_size = 40;
inline constexpr std::size_t data_max = 1024;
/// A package that has made this many hops is not passed on (P2P-08).
inline constexpr std::uint8_t hops_max = 14;
/// Fragments of the longest message: 16 MiB (P2P-05).
inline constexpr std::uint16_t fragments_max = 16384;

enum class package_type : std::uint8_t { link, broadcast, direct };

/// Names of services. Real kernels index arrays of 50 entries with a package's port (API-09).
namespace port {
inline constexpr std::uint16_t routing = 0;
inline constexpr std::uint16_t trace = 1;
inline constexpr std::uint16_t trace_reply = 2;
inline constexpr std::uint16_t subscribe = 5;
inline constexpr std::uint16_t unsubscribe = 6;
inline constexpr std::uint16_t push = 7;
inline constexpr std::uint16_t heartbeat = 8; ///< ours, between marked neighbours
inline constexpr std::uint16_t dead_host = 9;
inline constexpr std::uint16_t set = 10;
inline constexpr std::uint16_t clock = 11;
inline constexpr std::uint16_t host_query = 12;
inline constexpr std::uint16_t host_record = 13;
inline constexpr std::uint16_t acknowledgements = 14;
inline constexpr std::uint16_t append_request = 15;
inline constexpr std::uint16_t append_notice = 16;
inline constexpr std::uint16_t user_first = 20;
inline constexpr std::uint16_t count = 50;
} // namespace port

namespace package_flag {
inline constexpr std::uint16_t reliable = 1;
inline constexpr std::uint16_t bulk = 4;
inline constexpr std::uint16_t high = 8;
} // namespace package_flag

/// All fields travel in network byte order.
struct package_header {
  std::int32_t id = 0;       ///< > 0, new for each transmission by the originator
  std::uint32_t counter = 0; ///< per connection and direction, for loss statistics only
  std::int32_t ack_id = 0;   ///< equals id unless an acknowledgement is asked for
  std::uint16_t flags = 0;
  package_type type = package_type::direct;
  std::uint8_t hops = 1; ///< 1 at the originator
  peer_id source;
  peer_id destination = any_peer; ///< any_peer for link and broadcast
  std::uint16_t port = 0;
  std::uint16_t length = 0; ///< octets of data that follow
  std::uint16_t seqlen = 0; ///< number of fragments; 0: not a fragment
  std::uint16_t seqid = 0;  ///< groups the fragments of one message
  std::uint16_t seqnum = 0; ///< 0 to seqlen - 1

  [[nodiscard]] bool reliable() const { return (flags & package_flag::reliable) != 0; }

  friend bool operator==(const package_header&, const package_header&) = default;
};

/// Whether packages on this port carry tuples or messages of components.
[[nodiscard]] constexpr bool carries_content(std::uint16_t where) {
  return where == port::push || where == port::set || where == port::append_request ||
         where == port::append_notice || where >= port::user_first;
}

/// Identifies a package among all others, wherever it is met.
[[nodiscard]] constexpr std::uint64_t name_of(const package_header& x) {
  return std::uint64_t{static_cast<std::uint32_t>(x.source.value)} << 32U |
         static_cast<std::uint32_t>(x.id);
}

/// Appends the header's 40 octets.
void encode(const package_header& header, bytes& out);

/// Decodes the first 40 octets. An error means that the stream they come from is broken and must be
/// closed (docs/peis-wire.md 3.4): truncated; bad_value for a wrong sync word or a negative id;
/// too_long for more than 1024 octets of data.
[[nodiscard]] result<package_header> decode_header(byte_view octets);

/// May the package be handled and passed on? Checks what a real kernel fails to: type, port,
/// source, fragment numbers (docs/peis-wire.md 20).
[[nodiscard]] bool is_legal(const package_header& header);

} // namespace rubicon::peis
