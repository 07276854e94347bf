// Channels of Network, as the layer above knows them.
#pragma once

#include "network/channels/channel_message.hpp"
#include "stream/events.hpp"

namespace rubicon::mote {

[[nodiscard]] inline stream::channel_handle handle_of(network::channel_id x) {
  return stream::channel_handle(network::number_of(x));
}

[[nodiscard]] inline network::channel_id channel_of(stream::channel_handle x) {
  return network::channel_of(x.value);
}

} // namespace rubicon::mote
