#include "communication/ports/layer_ports.hpp"

namespace rubicon::communication {

namespace {

transport::messenger_config messages_of(const layer_config& config) {
  auto x = config.messages;
  x.self = config.self;
  x.incarnation = config.incarnation;
  return x;
}

transport::tunnels_config tunnels_of(const layer_config& config) {
  auto x = config.tunnels;
  x.self = config.self;
  x.slacks = config.messages.slacks;
  x.incarnation = config.incarnation;
  return x;
}

stream::streams_config streams_of(const layer_config& config) {
  auto x = config.streams;
  x.transducers = transducers_max;
  return x;
}

} // namespace

layer_ports::layer_ports(const layer_config& config, random_stream rng)
    : node{.config = config}, messages(node, programs, messages_of(config), rng),
      channels(node, messages.core(), tunnels_of(config)),
      streams(node, programs, channels, messages.core(), streams_of(config)),
      synaptic(node, programs, channels, messages.core(), config.synaptic),
      devices(node, programs, streams) {
  channels.set_users(streams, synaptic);
}

} // namespace rubicon::communication
