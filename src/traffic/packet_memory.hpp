// Which packets a mote has had already.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>

#include "core/address.hpp"

namespace rubicon::traffic {

enum class novelty : std::uint8_t {
  fresh,
  repeated, ///< it came from the same last hop before: that one did not receive the ack
  returned, ///< it came from another last hop before: it has gone in a circle
};

/// Remembers the last 64 numbers of each origin, for each last hop apart: packets on one path keep
/// their order, while those on another may be far ahead or behind.
class packet_memory {
public:
  static constexpr unsigned window = 64;
  static constexpr std::size_t last_hops_max = 64; ///< of an origin
  static constexpr std::size_t paths_max = 65536;  ///< pairs of origin and last hop

  /// A number that the window of its path has left behind counts as repeated.
  /// @returns nothing, and remembers nothing, if the packet's path would be one too many
  [[nodiscard]] std::optional<novelty> note(mote_id origin, mote_id last_hop, std::uint64_t number);

private:
  /// Bit i stands for the number newest - i.
  struct numbers {
    std::uint64_t newest = 0;
    std::uint64_t seen = 0; ///< 0 only before the first number

    [[nodiscard]] bool has(std::uint64_t number) const;
    [[nodiscard]] bool insert(std::uint64_t number); ///< false if it was there or is too old
  };

  std::map<std::pair<mote_id, mote_id>, numbers> paths_; ///< by origin, then last hop
};

} // namespace rubicon::traffic
