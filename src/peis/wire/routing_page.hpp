// One page of a peer's routing table, as neighbours exchange them (peis-wire.md 9.1, RTE-04).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/error.hpp"

namespace rubicon::peis {

inline constexpr std::size_t entries_per_page = 70;
inline constexpr std::size_t routing_pages_max = 32;
inline constexpr std::uint8_t connections_unknown = 255;

struct routing_entry {
  peer_id id;
  std::int32_t seqno = 0; ///< grows with each sending of that peer
  std::int32_t magic = 0;
  std::uint8_t hops = 0; ///< metric; 250 and above: not reachable
  std::uint8_t connections = connections_unknown;

  friend bool operator==(const routing_entry&, const routing_entry&) = default;
};

struct routing_page {
  std::uint16_t page = 0;
  std::uint16_t pages = 1;
  std::int32_t seqno = 0; ///< the sender's; equal on all pages of one sending
  std::vector<routing_entry> entries;

  friend bool operator==(const routing_page&, const routing_page&) = default;
};

[[nodiscard]] bytes encode(const routing_page& page);

/// truncated; too_long for more than 70 entries; bad_value for a page number not below the number
/// of pages, more than 32 pages, or a page that is not the last and not full.
[[nodiscard]] result<routing_page> decode_routing_page(byte_view octets);

/// Cuts a table into pages. Entries beyond 32 pages are left out. @pre entries has our own entry
[[nodiscard]] std::vector<routing_page> paginate(std::span<const routing_entry> entries,
                                                 std::int32_t seqno);

} // namespace rubicon::peis
