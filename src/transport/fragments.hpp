// Packets that do not fit one radio frame cross the island in fragments (NET-14, A-39, WIR-04).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/describe/fields.hpp"
#include "core/time.hpp"

namespace rubicon::transport {

inline constexpr std::size_t fragments_max = 16;

/// Cuts a packet. A fragment: its index in the high four bits of one octet, the index of the last
/// fragment in the low four; if there is more than one, an octet with `tag`; then its share of the
/// packet.
/// @param room octets of the longest fragment, 3 at least
/// @param tag distinguishes packets of one origin that are in flight at the same time
/// @returns nothing if it takes more than fragments_max
[[nodiscard]] std::optional<std::vector<bytes>> cut(byte_view packet, std::size_t room,
                                                    std::uint8_t tag);

struct assembly_config {
  std::size_t packets_max = 1; ///< that are incomplete; one more drops the oldest
  duration patience = 10s;     ///< between two fragments of a packet
};

struct assembly_counters {
  std::uint64_t malformed = 0;
  std::uint64_t incomplete = 0; ///< packets given up
};
RUBICON_FIELDS(assembly_counters, malformed, incomplete);

/// Puts fragments together again, whatever their order.
class assembly {
public:
  assembly() = default;
  explicit assembly(assembly_config config) : config_(config) {}

  /// @returns the packet that this fragment completes
  [[nodiscard]] std::optional<bytes> on_fragment(mote_id origin, byte_view fragment, instant now);

  [[nodiscard]] const assembly_counters& counters() const { return counters_; }
  [[nodiscard]] std::size_t footprint(std::size_t packet_max) const {
    return config_.packets_max * (packet_max + 10);
  }

private:
  struct packet {
    mote_id origin;
    std::uint8_t tag = 0;
    std::vector<std::optional<bytes>> fragments;
    instant last_received;
  };

  void drop_late(instant now);

  assembly_config config_;
  std::vector<packet> packets_; ///< the oldest first
  assembly_counters counters_;
};

} // namespace rubicon::transport
