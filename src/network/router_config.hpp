// The settings of a router: its mote and its island, and what follows for its parts.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/address.hpp"
#include "core/island_time.hpp"
#include "core/time.hpp"
#include "network/channels/channels.hpp"
#include "network/duty_window.hpp"
#include "network/places/place_cache.hpp"
#include "network/time_sync.hpp"
#include "network/tree/collection.hpp"
#include "network/tree/neighbours.hpp"
#include "network/tree/route_help.hpp"
#include "network/tree/trickle.hpp"

namespace rubicon::network {

/// The ends of backbones: of a further sink the island's sink, of that all further ones. What is
/// sent to all goes over each backbone, too, and what is sent to one of these over its backbone
/// alone.
struct backbone_ends {
  std::vector<mote_id> motes;
  std::chrono::microseconds doubt{}; ///< how far the age of what comes may be wrong

  friend bool operator==(const backbone_ends&, const backbone_ends&) = default;
};

/// Of the router itself.
struct own_router_config {
  mote_id self;
  bool is_sink = false;
  std::uint8_t era = 0; ///< the sink's last one (clock_sync)
  tick_setting tick;    ///< the sink's (CLK-03)
  duty_window duty;     ///< when radios are on
  duration wake{};      ///< access_times::wake
  backbone_ends backbone;
  std::size_t questions_max = 2; ///< in flight: where a mote is

  /// The longest wait for the sink's answer where a mote is, where no frame waits for a turn.
  static constexpr duration question_timeout = 3s;

  static constexpr std::size_t places_max = 1000;   ///< of motes, that the sink remembers
  static constexpr std::size_t places_kept = 6;     ///< that a mote learns from passing packets
  static constexpr duration place_lifetime = 10min; ///< of those
  static constexpr std::size_t direct_max = 4;      ///< packets for neighbours in flight

  /// A beacon comes within this time of a change of coordinates, and as often from those that look
  /// for a route.
  [[nodiscard]] duration change_beacon() const;
  /// What goes to everybody is to take several hops in a window.
  [[nodiscard]] duration spread_in_window() const { return duty.length / 8; }
  /// A mote that has started beacons soon, where radios sleep in the next window: within this time
  /// all neighbours have received it, if some beacons get lost.
  [[nodiscard]] duration beacon_wait() const;
};

struct router_config : own_router_config {
  channels_config paths;     ///< sizes of tables and queues; a sink's are larger at least; the next
  collection_config packets; ///< too
  trickle_config beacons;
};

[[nodiscard]] neighbours_config links_of(const router_config& config);
[[nodiscard]] trickle_config beacons_of(const router_config& config);
[[nodiscard]] route_help_config help_of(const own_router_config& config);
[[nodiscard]] time_sync_config time_of(const own_router_config& config);
[[nodiscard]] collection_config packets_of(const router_config& config);
[[nodiscard]] channels_config paths_of(const router_config& config);
[[nodiscard]] place_cache places_of(const own_router_config& config);

} // namespace rubicon::network
