// What channels have for the owner of a mote's Network module.
#pragma once

#include <optional>
#include <variant>
#include <vector>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "network/channels/channel_message.hpp"
#include "network/channels/hop_queue.hpp"

namespace rubicon::network {

/// As source: the channel is open.
struct channel_connected {
  channel_id channel;
};

/// As destination: a channel to us was opened.
struct channel_accepted {
  channel_id channel;
};

struct channel_received {
  channel_id channel;
  bytes content;
};

/// The channel is gone, at source or destination; also when it never came to be.
struct channel_ended {
  channel_id channel;
  channel_end why = channel_end::broken;
};

/// At any mote on the path: the radio is needed at these times, or no longer (schedule.interval 0).
struct channel_reserved {
  channel_id channel;
  /// `first` is when a packet comes here, at the source when it leaves.
  channel_schedule schedule;
  std::optional<mote_id> previous = {}; ///< who it comes from; nothing at the source
};

using channels_output = std::variant<channel_hop, channel_connected, channel_accepted,
                                     channel_received, channel_ended, channel_reserved>;
using channels_outputs = std::vector<channels_output>;

} // namespace rubicon::network
