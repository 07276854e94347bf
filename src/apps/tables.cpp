#include "apps/tables.hpp"

#include <algorithm>

namespace rubicon::apps {

namespace {

struct demand {
  std::size_t streams = 0; ///< sensor streams and ends of remote ones
  std::size_t ins = 0;     ///< ends of synaptic channels; the next too
  std::size_t outs = 0;
  std::uint8_t elements = 0; ///< of the longest vector

  void operator()(const stream_writer_config&) { streams += 2; }
  void operator()(const stream_reader_config&) { ++streams; }
  void operator()(const reservoir_config& x) {
    streams += x.transducers.size();
    add(x.from, ins);
    add(x.to, outs);
  }
  void operator()(const readout_config& x) { add(x.from, ins); }
  void operator()(const average_config& x) { streams += x.streams.size() + x.outputs.size(); }
  void operator()(const stream_switch_config&) { ++streams; }
  void operator()(const recorder_config& x) { streams += x.streams.size(); }
  void operator()(const custom_config& x) { streams += x.kind->streams; }

  void add(const std::vector<synapse>& ends, std::size_t& count) {
    count += ends.size();
    for (const auto& x : ends)
      elements = std::max(elements, x.size);
  }
};

/// A queue holds four vectors of the longest kind, and what the mote itself sends beyond two of
/// them, since that comes all at once.
void make_room(std::size_t& packets_max, std::size_t& octets_max, const load& own,
               const load& longest) {
  auto room = 4 * longest;
  room += beyond(own, 2 * longest);
  if (own.packets > room.packets / 2) // what is left of the last tick, and control messages
    room += {own.packets / 4, own.octets / 4};
  packets_max = std::max(packets_max, room.packets);
  octets_max = std::max(octets_max, room.octets);
}

} // namespace

void make_room(communication::layer_config& tables, const std::vector<app_config>& programs) {
  demand wanted;
  for (const auto& x : programs)
    std::visit(wanted, x);
  const auto all = traffic_of(own_island, programs);
  auto& synaptic = tables.synaptic;
  tables.unclaimed_max = std::max(tables.unclaimed_max, all.streams_in + all.synapses_in);
  tables.streams.early_max = std::max(tables.streams.early_max, all.streams_in);
  synaptic.early_max = std::max(synaptic.early_max, all.synapses_in);
  tables.streams.streams_max = std::max(tables.streams.streams_max, wanted.streams);
  synaptic.channels_max = std::max({synaptic.channels_max, wanted.ins, wanted.outs});
  synaptic.size_max = std::max(synaptic.size_max, wanted.elements);
  tables.tunnels.tunnels_max =
      std::max(tables.tunnels.tunnels_max, wanted.streams + wanted.ins + wanted.outs);
}

std::size_t ends_max(std::size_t least, const std::vector<app_config>& programs) {
  demand wanted;
  for (const auto& x : programs)
    std::visit(wanted, x);
  return std::max({least, wanted.streams, wanted.ins, wanted.outs});
}

void make_room(network::router_config& tables, const traffic& own, const traffic& of_island) {
  auto& paths = tables.paths;
  const auto ends = own.channels + own.streams_in + own.synapses_in;
  // A half more: a channel that has not come about keeps its entry for a while.
  const auto channels = of_island.channels > 1 ? of_island.channels * 3 / 2 : 1;
  paths.entries_max = std::max(paths.entries_max, std::min(channels, ends + passing_channels_max));
  if (of_island.channels > paths.offers_max * 2) // many are looked for at the same time, at first
    paths.offers_max = std::max(paths.offers_max, std::min<std::size_t>(of_island.channels, 24));
  // A packet of each fourth may wait, and control messages as well.
  paths.queue_max = std::max(paths.queue_max, paths.entries_max / 4);
  paths.octets_max = std::max(paths.octets_max, paths.queue_max * 18);
  tables.questions_max = std::max(tables.questions_max, own.channels);
  make_room(paths.queue_max, paths.octets_max, own.vectors, of_island.longest);
  make_room(tables.packets.queue_max, tables.packets.octets_max, own.up,
            of_island.longest_tunnelled);
}

} // namespace rubicon::apps
