// All ports of one layer, and the state that they share.
#pragma once

#include "communication/ports/channel_port.hpp"
#include "communication/ports/device_port.hpp"
#include "communication/ports/local_node.hpp"
#include "communication/ports/message_port.hpp"
#include "communication/ports/program_list.hpp"
#include "communication/ports/stream_port.hpp"
#include "communication/ports/synaptic_port.hpp"
#include "core/numbers/random.hpp"
#include "stream/streams.hpp"
#include "synaptic/channels.hpp"
#include "transport/messenger.hpp"
#include "transport/tunnels.hpp"

namespace rubicon::communication {

struct layer_config : own_layer_config {
  transport::messenger_config messages;
  transport::tunnels_config tunnels;
  stream::streams_config streams;
  synaptic::channels_config synaptic;
};

/// At one address: each port refers to the ones before it.
struct layer_ports {
  layer_ports(const layer_config& config, random_stream rng);
  layer_ports(const layer_ports&) = delete;
  layer_ports& operator=(const layer_ports&) = delete;

  local_node node;
  program_list programs;
  message_port messages;
  channel_port channels;
  stream_port streams;
  synaptic_port synaptic;
  device_port devices;
};

} // namespace rubicon::communication
