#include "config/checks/window_room.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <utility>
#include <variant>
#include <vector>

#include "config/checks/connectivity.hpp"
#include "core/numbers/math.hpp"
#include "core/overloads.hpp"
#include "core/text/decimal.hpp"
#include "radio/mac_rules.hpp"
#include "radio/medium/tossim_files.hpp"

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

// What one packet takes of a window. The next one can follow when it is three hops ahead; of longer
// routes the packets disturb each other.
constexpr duration packet_time = 9ms;
constexpr duration packet_time_hop = 1600us; // of each hop after the third
constexpr unsigned hops_measured = 8;
// An answer that comes down goes at the beginning of a window, when the sink sends all it has.
constexpr double acknowledged_weight = 2.5;
constexpr double tunnel_weight = 2;
constexpr double share_max = 0.8; // from here on one window more or less makes the difference

duration packet_time_of(unsigned hops, double loss) {
  const auto more = std::clamp(hops, 3U, hops_measured) - 3;
  const auto once = packet_time + static_cast<duration::rep>(more) * packet_time_hop;
  const auto arrives = std::max(1 - loss, 0.1);
  return std::chrono::duration_cast<duration>(once / (arrives * arrives));
}

duration rounded_up(duration window) {
  constexpr duration step = 10ms;
  return (window + step - duration(1)) / step * step;
}

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

std::optional<double> range_of(const radio::channel_config& x) {
  const auto* disk = std::get_if<radio::unit_disk>(&x.propagation);
  return disk != nullptr ? std::optional(disk->range_m) : std::nullopt;
}

std::vector<unsigned> hops_to_sink(const island_description& x, std::optional<double> range_m) {
  std::vector<unsigned> hops(x.motes.size(), 1);
  if (!range_m)
    return hops;
  std::vector<position> places{x.sink.place};
  for (const auto& mote : x.motes)
    places.push_back(mote.place);
  const auto all = hops_from(places, 0, *range_m);
  for (std::size_t i = 0; i < hops.size(); ++i)
    hops[i] = std::max(all[i + 1], 1U);
  return hops;
}

std::size_t beacons_in(duration window) {
  return static_cast<std::size_t>(window * open_quarters / 4 / beacon_time);
}

duration window_for(std::size_t beacons) {
  return rounded_up(static_cast<duration::rep>(beacons) * beacon_time * 4 / open_quarters);
}

namespace {

template <class App, class Function>
void for_each_stream(const island_description& x, Function&& function) {
  for (const auto& mote : x.motes)
    for (const auto& app : mote.apps)
      if (const auto* other = std::get_if<apps::app_config>(&app))
        if (const auto* end = std::get_if<App>(other); end != nullptr && end->every > 0s)
          function(mote.id, *end);
}

/// Times between the records of streams with one end in the island: those with two have channels
/// with times of their own.
std::vector<duration> tunnelled_streams(const island_description& x) {
  std::vector<duration> all;
  std::set<std::pair<mote_id, std::uint16_t>> near;
  for_each_stream<apps::stream_writer_config>(x, [&](mote_id, const auto& writer) {
    const bool is_here = writer.to.island == x.id || writer.to.island == own_island;
    if (is_here && writer.to.mote != no_mote)
      near.emplace(writer.to.mote, writer.stream);
    else
      all.push_back(writer.every);
  });
  for_each_stream<apps::stream_reader_config>(x, [&](mote_id mote, const auto& reader) {
    if (!near.contains({mote, reader.stream}))
      all.push_back(reader.every);
  });
  return all;
}

} // namespace

double packets_per_window(const island_description& x) {
  double per_second = 0;
  for (const auto& mote : x.motes)
    per_second += messages_per_second(mote, acknowledged_weight);
  double per_window = 0;
  for (const auto every : tunnelled_streams(x)) {
    per_second += tunnel_weight / seconds(every);
    per_window += tunnel_weight * 2 / 4; // keep-alives both ways (transport/tunnels.hpp)
  }
  return per_window + per_second * seconds(x.duty.period);
}

double packets_in(duration window, unsigned hops, double loss) {
  return share_max * seconds(window * open_quarters / 4) / seconds(packet_time_of(hops, loss));
}

duration window_for(double packets, unsigned hops, double loss) {
  const auto least = packets / share_max * seconds(packet_time_of(hops, loss)) * 4 / open_quarters;
  return rounded_up(std::chrono::duration_cast<duration>(std::chrono::duration<double>(least)));
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

double messages_per_second(const mote_description& x, double reliable_weight) {
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
      sum += (reliable ? reliable_weight : 1) / seconds(*every);
  }
  return sum;
}

double messages_per_second(const island_description& x) {
  double sum = 0;
  for (const auto& mote : x.motes)
    sum += messages_per_second(mote);
  return sum;
}

std::string warning_of_window(const island_description& x, const radio::channel_config& radio) {
  if (!x.duty.enabled)
    return {};
  const auto room = beacons_in(x.duty.window);
  const auto crowd = crowd_of(x, radio);
  unsigned hops = 1;
  for (const auto each : hops_to_sink(x, range_of(radio)))
    hops = std::max(hops, each);
  const auto packets = packets_per_window(x);
  const auto carried = packets_in(x.duty.window, hops, radio.loss);
  if (crowd <= room && packets <= carried)
    return {};
  const auto needed = std::max(window_for(crowd), window_for(packets, hops, radio.loss));
  auto text = "a window of " + to_text(x.duty.window);
  if (crowd > room)
    text += " has room for " + std::to_string(room) + " beacons, but " + std::to_string(crowd) +
            " motes in range of each other share it: after a restart of the sink they are missing "
            "for a long time";
  else
    text += " carries about " + decimal_text(carried, 1) + " packets over " +
            (hops == 1 ? "1 hop" : std::to_string(hops) + " hops") +
            ", but the programs of the island send " + decimal_text(packets, 1) +
            " per window, answers included: many are lost, and motes leave the island";
  text += "; " + to_text(needed) + " would do";
  if (2 * needed > x.duty.period)
    text += ", with a period of " + to_text(2 * needed) + " at least";
  return text;
}

std::string warning_of_traffic(const island_description& x) {
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
