#include "config/window_room.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <variant>
#include <vector>

#include "core/math.hpp"
#include "core/overloads.hpp"
#include "radio/mac_rules.hpp"
#include "radio/tossim_files.hpp"

namespace rubicon::config {

namespace {

// IEEE 802.15.4-2006, 2.4 GHz: 250 kbit/s.
constexpr int frame_octets = 6 + 127; // preamble, delimiter and length; the longest PSDU
constexpr duration back_off = 320us;  // of those who wait for the end of a frame one draws next to
                                      // nothing; the next one a unit more
constexpr duration assessment = 128us;
constexpr duration turnaround = 192us;
constexpr duration beacon_time =
    frame_octets * radio::timing::octet + back_off + assessment + turnaround;

// Frames begin in the first three quarters (network/turns.hpp).
constexpr int open_quarters = 3;

struct listener {
  mote_id id;
  position place;
  double transmit_dbm = 0;
  double sensitivity_dbm = 0;
};

template <class Node>
listener station_of(const Node& x, const radio::channel_config& radio) {
  return {x.id, x.place, x.transmit_dbm.value_or(x.platform->transmit_dbm_max()),
          radio.sensitivity_dbm.value_or(x.platform->sensitivity_dbm)};
}

/// Of radios whose links follow from where they stand: what is lost on the way. [dB]
double loss_db(const radio::propagation& x, double distance_m) {
  return std::visit(
      overloads{[&](const radio::unit_disk& y) {
                  return distance_m <= y.range_m ? 0 : std::numeric_limits<double>::infinity();
                },
                [&](const radio::log_distance& y) {
                  return y.reference_db + 10 * y.exponent * std::log10(std::max(distance_m, 1.0));
                },
                [&](const radio::friis& y) {
                  constexpr double light_m_s = 299'792'458;
                  const auto ratio =
                      4 * std::numbers::pi * distance_m * y.frequency_mhz * 1e6 / light_m_s;
                  return std::max(0.0, 20 * std::log10(std::max(ratio, 1e-9)));
                },
                [](const radio::gain_matrix&) { return std::numeric_limits<double>::infinity(); }},
      x);
}

std::size_t crowd_of_table(const std::vector<listener>& all, const radio::gain_matrix& x) {
  std::map<std::uint32_t, const listener*> by_node;
  for (const auto& each : all)
    if (each.id.value >= x.first_mote)
      by_node.emplace(each.id.value - x.first_mote, &each);
  std::map<std::uint32_t, std::size_t> heard;
  std::size_t most = 1;
  for (const auto& link : x.table->gains) {
    const auto from = by_node.find(link.from);
    const auto to = by_node.find(link.to);
    if (from == by_node.end() || to == by_node.end() ||
        from->second->transmit_dbm + link.db < to->second->sensitivity_dbm)
      continue;
    most = std::max(most, ++heard[link.to] + 1);
  }
  return most;
}

} // namespace

std::size_t beacons_in(duration window) {
  return static_cast<std::size_t>(window * open_quarters / 4 / beacon_time);
}

duration window_for(std::size_t beacons) {
  constexpr duration step = 10ms;
  const auto least = static_cast<duration::rep>(beacons) * beacon_time * 4 / open_quarters;
  return (least + step - duration(1)) / step * step;
}

std::size_t crowd_of(const island_description& x, const radio::channel_config& radio) {
  constexpr std::size_t places_max = 200;
  std::vector<listener> all{station_of(x.sink, radio)};
  for (const auto& mote : x.motes)
    all.push_back(station_of(mote, radio));
  if (const auto* table = std::get_if<radio::gain_matrix>(&radio.propagation))
    return table->table == nullptr ? 0 : crowd_of_table(all, *table);
  std::size_t most = 0;
  const auto stride = std::max<std::size_t>(all.size() / places_max, 1);
  for (std::size_t i = 0; i < all.size(); i += stride) {
    const auto& here = all[i];
    most =
        std::max(most, static_cast<std::size_t>(std::ranges::count_if(all, [&](const auto& y) {
                   const auto distance_m =
                       math::length(y.place.x_m - here.place.x_m, y.place.y_m - here.place.y_m,
                                    y.place.z_m - here.place.z_m);
                   return &y == &here || y.transmit_dbm - loss_db(radio.propagation, distance_m) >=
                                             here.sensitivity_dbm;
                 })));
  }
  return most;
}

double messages_per_second(const mote_description& x) {
  double sum = 0;
  for (const auto& app : x.apps) {
    std::optional<duration> every;
    bool reliable = false;
    if (const auto* sampler = std::get_if<sampler_app>(&app)) {
      every = sampler->dead_band.empty() ? sampler->every : sampler->silence_max;
      reliable = sampler->reliable;
    } else if (const auto* messenger = std::get_if<messenger_app>(&app)) {
      every = messenger->every;
      reliable = messenger->reliable;
    }
    if (every && *every > 0s)
      sum += (reliable ? 2 : 1) / seconds(*every);
  }
  return sum;
}

double messages_per_second(const island_description& x) {
  double sum = 0;
  for (const auto& mote : x.motes)
    sum += messages_per_second(mote);
  return sum;
}

std::string doubt_of_window(const island_description& x, const radio::channel_config& radio) {
  if (!x.duty.enabled)
    return {};
  const auto room = beacons_in(x.duty.window);
  const auto crowd = crowd_of(x, radio);
  const auto messages =
      static_cast<std::size_t>(std::ceil(messages_per_second(x) * seconds(x.duty.period)));
  if (std::max(crowd, messages) <= room)
    return {};
  const auto needed = window_for(std::max(crowd, messages));
  auto text = "a window of " + to_text(x.duty.window) + " has room for " + std::to_string(room) +
              " beacons, but ";
  text += crowd > room
              ? std::to_string(crowd) + " motes in range of each other share it: after a restart "
                                        "of the sink they are missing for a long time"
              : "each of them has " + std::to_string(messages) + " messages: many are lost";
  text += "; " + to_text(needed) + " would do";
  if (2 * needed > x.duty.period)
    text += ", with a period of " + to_text(2 * needed) + " at least";
  return text;
}

std::string doubt_of_traffic(const island_description& x) {
  const auto rate = messages_per_second(x);
  if (x.duty.enabled || x.listening.enabled() || rate <= sink_carries)
    return {};
  const auto times = static_cast<int>(std::ceil(rate / sink_carries));
  return "its motes send " + std::to_string(static_cast<int>(rate)) +
         " messages per second, but the radio of a sink carries about " +
         std::to_string(static_cast<int>(sink_carries)) +
         ": many are lost, and motes are considered lost; periods " + std::to_string(times) +
         " times as long would do";
}

} // namespace rubicon::config
