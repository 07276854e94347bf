// What octets of each leg of the path carry, by the product's own decoders.
#pragma once

#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "peis/tuples/tuple.hpp"
#include "peis/wire/package.hpp"

namespace rubicon::explain {

/// A packet between two ends, of which fragments may be missing at the end.
struct envelope {
  mote_address source; ///< of its island; the mote is what the body says
  mote_address destination;
  std::uint16_t channel = 0; ///< AM type, or above 255 a tunnel's
  bytes body;
};

/// Which fragment of a packet this is; `last` is 0 for a whole one.
struct fragment {
  std::uint8_t index = 0;
  std::uint8_t last = 0;
  bytes content;
};

[[nodiscard]] std::optional<fragment> fragment_of(byte_view octets);

/// A fragment of a packet in transit through an island.
struct carried_fragment {
  bool is_down = false; ///< its header says where it comes from
  fragment part;
};

/// Something on a channel of an island's Network: a stream's record or a synaptic vector.
struct channel_content {
  std::uint32_t channel = 0; ///< source and number
  bytes content;
};

using frame_content = std::variant<std::monostate, carried_fragment, channel_content>;

/// Of a radio frame's payload. @param sender of the frame
[[nodiscard]] frame_content frame_content_of(std::uint8_t am_type, byte_view payload,
                                             mote_id sender, mote_id sink);

/// In the octets of one write to a serial line.
[[nodiscard]] std::optional<carried_fragment> serial_part_of(byte_view octets, bool to_mote);

/// @param packet a D1.1 5.4 packet of an island, whole or only its beginning
/// @param is_down whether its island is where it comes from
/// @returns nothing if not even its header is there
[[nodiscard]] std::optional<envelope> envelope_of(byte_view packet, bool is_down, island_id here);

/// Of a message between gateways or PCs.
[[nodiscard]] std::optional<envelope> envelope_of(byte_view message, peer_id source,
                                                  peer_id destination);

/// A package on a link.
struct carried_package {
  peis::package_header header;
  bytes data;
};
[[nodiscard]] std::optional<carried_package> package_of(byte_view octets);

/// The beginning of a push or set message of several fragments, too: then the value is incomplete.
[[nodiscard]] std::optional<peis::tuple> tuple_of(const carried_package& x);

} // namespace rubicon::explain
