#include "network/router_config.hpp"

#include <algorithm>
#include <limits>

#include "network/slot_time.hpp"

namespace rubicon::network {

namespace {

constexpr duration reborn_quiet = 200ms;
constexpr duration sleeping_round = 30s; ///< between rounds of the clock where radios sleep
constexpr duration beacon_soon = 1s;

/// Where radios listen at low power, a broadcast occupies the air for a whole interval: beacons are
/// so many of its lengths apart at least.
constexpr int beacon_lengths = 4;

/// Who sleeps has no better sign of a root that has gone than rounds that do not come.
clock_sync_config clock_of(const own_router_config& config) {
  clock_sync_config x;
  x.self = config.self;
  x.is_root = config.is_sink;
  x.era = config.era;
  x.tick = config.tick;
  x.resume_wait += config.duty.period + config.duty.length;
  if (config.duty.enabled()) {
    x.period = std::max(sleeping_round, config.duty.period);
    x.stale_after = 3 * x.period;
  }
  if (config.wake > 0s) {
    x.resume_wait += 2 * config.wake;
    x.period_first = std::max(x.period_first, beacon_lengths * config.wake);
    x.period = std::max(x.period, round_lengths * config.wake);
    x.period_least = std::max(x.period_least, round_lengths / 6 * config.wake);
    x.stale_after = 3 * x.period;
  }
  return x;
}

/// A sink that has lived before has motes that know the time.
time_search_config search_of(const own_router_config& config) {
  time_search_config x;
  x.is_root = config.is_sink;
  x.duty = config.duty;
  if (config.is_sink && config.era > 0)
    x.start_quiet = reborn_quiet;
  if (config.wake > 0s) {
    x.start_quiet += beacon_lengths * config.wake;
    x.company = std::max(x.company, beacon_lengths * config.wake);
    x.stale_spread = std::max(x.stale_spread, beacon_lengths * config.wake);
    x.pause = std::max(x.pause, beacon_lengths * config.wake);
    x.pause_max = std::max(x.pause_max, x.pause);
  }
  return x;
}

relay_config relay_of(const own_router_config& config) {
  relay_config x;
  x.spread = std::max(x.spread, config.wake);
  x.pause = std::max(x.pause, 2 * config.wake);
  if (config.duty.enabled()) {
    x.spread = std::min(x.spread, config.spread_in_window());
    x.pause = 2 * config.spread_in_window();
  }
  if (config.wake > 0s)
    x.relays_max = 1; // all neighbours can have received it then
  return x;
}

answers_config answers_of(const own_router_config& config) {
  if (config.duty.enabled())
    return {.spread = 30ms, .gap = 40ms, .each = 2};
  answers_config x;
  x.spread = std::max(x.spread, config.wake);
  x.gap = std::max(x.gap, 2 * config.wake);
  return x;
}

} // namespace

duration own_router_config::change_beacon() const {
  return std::max({beacon_soon, 2 * wake, duty.period});
}

duration own_router_config::beacon_wait() const {
  return beacon_soon + 2 * duty.period + 2 * beacon_lengths * wake;
}

neighbours_config links_of(const router_config& config) {
  neighbours_config x;
  if (config.is_sink)
    x.capacity = 24 + config.backbone.motes.size();
  x.backbone = config.backbone.motes;
  // A beacon a window: links must be known after few. Windows are crowded: a link over which nearly
  // every unicast arrives, which is sent again, may lose half of its beacons.
  if (config.duty.enabled()) {
    x.good_samples = 2;
    x.usable_samples = 2;
    x.unusable_missed = 4;
    x.bad_missed = 5;
    x.good_from = quality_of(0.5);
    x.bad_below = quality_of(0.25);
    x.beacon_slack += config.duty.period;
    x.beacon_gap_max += config.duty.period;
  }
  // Beacons are rare, and each is repeated until all neighbours can have received it.
  if (config.wake > 0s) {
    x.good_samples = 2;
    x.usable_samples = 2;
    x.beacon_slack += 2 * config.wake;
    x.beacon_gap_max += 2 * config.wake;
  }
  return x;
}

/// Others are of no use until they know a route to the sink: it does not keep quiet for them.
trickle_config beacons_of(const router_config& config) {
  auto x = config.beacons;
  if (config.duty.enabled()) {
    x.interval_min = std::clamp(config.duty.period, x.interval_min, x.interval_max);
    x.shortest = 5;
  }
  if (config.wake > 0s) {
    x.interval_min = std::clamp(beacon_lengths * config.wake, x.interval_min, x.interval_max);
    x.shortest = 2;
  }
  if (config.is_sink || !config.backbone.motes.empty())
    x.redundancy = std::numeric_limits<unsigned>::max();
  return x;
}

route_help_config help_of(const own_router_config& config) {
  route_help_config x;
  x.help_gap = std::max(x.help_gap, 2 * config.wake);
  x.sequence_gap += beacon_lengths * config.wake + 2 * config.duty.period;
  return x;
}

time_sync_config time_of(const own_router_config& config) {
  return {.clock = clock_of(config),
          .search = search_of(config),
          .relay = relay_of(config),
          .answers = answers_of(config),
          .duty = config.duty};
}

/// A sink has a PC's memory and power; so has it in paths_of().
collection_config packets_of(const router_config& config) {
  auto x = config.packets;
  x.self = config.self;
  x.is_root = config.is_sink;
  if (config.is_sink) {
    x.queue_max = std::max<std::size_t>(x.queue_max, 32);
    x.octets_max = std::max(x.octets_max, 32 * frame_payload_max);
    x.seen_max = 64;
  }
  x.flood_spread = std::max(x.flood_spread, config.wake);
  return x;
}

channels_config paths_of(const router_config& config) {
  auto x = config.paths;
  x.self = config.self;
  if (config.is_sink) {
    x.entries_max = std::max<std::size_t>(x.entries_max, 32);
    x.offers_max = 12;
    x.queue_max = std::max<std::size_t>(x.queue_max, 16);
    x.octets_max = std::max(x.octets_max, 16 * channel_packet_max);
  }
  if (config.duty.enabled()) {
    x.round_pause = 8ms;   // the next mote waits for a late packet
    x.data_rounds_max = 4; // the second one waits for a window: then it had better arrive
    x.flood_spread = std::min(x.flood_spread, config.spread_in_window());
  }
  x.wake = config.wake;
  x.flood_spread = std::max(x.flood_spread, config.wake);
  return x;
}

place_cache places_of(const own_router_config& config) {
  return config.is_sink ? place_cache(config.places_max, 0s)
                        : place_cache(config.places_kept, config.place_lifetime);
}

} // namespace rubicon::network
