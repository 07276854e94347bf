#include "apps/traffic.hpp"

#include <variant>

namespace rubicon::apps {

namespace {

struct counter {
  island_id island;
  traffic sum;

  [[nodiscard]] bool is_near(mote_address x) const {
    return x.mote != no_mote && (x.island == island || x.island == own_island);
  }

  void stream_to(mote_address x) { sum.channels += is_near(x) ? 1 : 0; }

  void in(const std::vector<synapse>& ends) {
    for (const auto& x : ends) {
      ++sum.synapses_in;
      if (is_near(x.other)) {
        sum.vectors_in += vector_load(x.size);
        sum.longest = longer(sum.longest, vector_load(x.size));
      } else {
        sum.down += tunnel_load(x.size);
        sum.longest_tunnelled = longer(sum.longest_tunnelled, tunnel_load(x.size));
      }
    }
  }

  void out(const std::vector<synapse>& ends) {
    for (const auto& x : ends) {
      if (is_near(x.other)) {
        ++sum.channels;
        sum.vectors += vector_load(x.size);
        sum.longest = longer(sum.longest, vector_load(x.size));
      } else {
        sum.up += tunnel_load(x.size);
        sum.longest_tunnelled = longer(sum.longest_tunnelled, tunnel_load(x.size));
      }
    }
  }

  void operator()(const stream_writer_config& x) { stream_to(x.to); }
  void operator()(const stream_reader_config&) { ++sum.streams_in; }
  void operator()(const reservoir_config& x) {
    in(x.from);
    out(x.to);
  }
  void operator()(const readout_config& x) { in(x.from); }
  void operator()(const average_config& x) {
    sum.streams_in += x.streams.size();
    for (const auto& each : x.outputs)
      stream_to(each.to);
  }
  void operator()(const stream_switch_config&) { ++sum.streams_in; }
  void operator()(const recorder_config& x) { sum.streams_in += x.streams.size(); }
  void operator()(const custom_config& x) { // which of them are read is unknown
    sum.channels += x.kind->streams;
    sum.streams_in += x.kind->streams;
  }
};

} // namespace

traffic traffic_of(island_id island, const std::vector<app_config>& programs) {
  counter all{island, {}};
  for (const auto& x : programs)
    std::visit(all, x);
  return all.sum;
}

} // namespace rubicon::apps
