// What the Network module of a node has for its owner.
#pragma once

#include <optional>
#include <variant>
#include <vector>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "network/channels/channels_output.hpp"
#include "network/frames/frame_out.hpp"

namespace rubicon::network {

/// For the user of Network at this node.
struct content_in {
  std::optional<mote_id> origin; ///< a mote of the island; nothing: what came down says itself
  bool to_all = false;
  bytes content;
};

/// The island's clock has been corrected, or is known now.
struct clock_corrected {};

using router_output =
    std::variant<frame_out, content_in, clock_corrected, channel_connected, channel_accepted,
                 channel_received, channel_ended, channel_reserved>;
using router_outputs = std::vector<router_output>;

} // namespace rubicon::network
