// All that the parts of a node's Communication Layer count.
#pragma once

#include "communication/ports/local_node.hpp"
#include "core/describe/fields.hpp"
#include "stream/streams.hpp"
#include "synaptic/channels.hpp"
#include "transport/messenger.hpp"
#include "transport/tunnels.hpp"

namespace rubicon::communication {

class layer;

struct layer_totals {
  layer_counters layer;
  stream::streams_counters streams;
  synaptic::channels_counters synaptic;
  transport::messenger_counters transport;
  transport::tunnels_counters tunnels;
};
RUBICON_FIELDS(layer_totals, layer, streams, synaptic, transport, tunnels);

[[nodiscard]] layer_totals totals_of(const layer& x);

} // namespace rubicon::communication
