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

  void add(const std::vector<synapse>& ends, std::size_t& count) {
    count += ends.size();
    for (const auto& x : ends)
      elements = std::max(elements, x.size);
  }
};

} // namespace

void make_room(mote::layer_config& tables, const std::vector<app_config>& programs) {
  demand wanted;
  for (const auto& x : programs)
    std::visit(wanted, x);
  auto& synaptic = tables.synaptic;
  tables.streams.streams_max = std::max(tables.streams.streams_max, wanted.streams);
  synaptic.channels_max = std::max({synaptic.channels_max, wanted.ins, wanted.outs});
  synaptic.size_max = std::max(synaptic.size_max, wanted.elements);
  tables.tunnels.tunnels_max =
      std::max(tables.tunnels.tunnels_max, wanted.streams + wanted.ins + wanted.outs);
}

} // namespace rubicon::apps
