// The frames of a mote: what its parts hand out becomes a frame, for the radio or a backbone.
#pragma once

#include <cstdint>
#include <optional>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "network/channels/hop_queue.hpp"
#include "network/frames/frame_out.hpp"
#include "network/frames/frame_tokens.hpp"
#include "network/router_config.hpp"
#include "network/router_output.hpp"
#include "network/tree/collection.hpp"
#include "network/tree/neighbours.hpp"

namespace rubicon::network {

/// Knows what each frame stands for, and to whom those went that have not ended.
class outgoing_frames {
public:
  outgoing_frames() = default;
  explicit outgoing_frames(backbone_ends backbone) : backbone_(std::move(backbone)) {}

  [[nodiscard]] frame_out make(frame_purpose why, mote_id to, std::uint8_t am_type, bytes payload);

  /// What is sent to all also goes over each backbone, as a copy that is not acknowledged.
  void send(frame_out x, const neighbours& links, router_outputs& out);
  void send(hop x, const neighbours& links, router_outputs& out);
  void send(channel_hop x, const neighbours& links, router_outputs& out);

  /// The end of a frame. @returns to whom it was sent; nothing: it was no unicast
  [[nodiscard]] std::optional<mote_id> on_sent(std::uint64_t token) {
    return tokens_.on_sent(token);
  }

private:
  backbone_ends backbone_;
  frame_tokens tokens_;
};

} // namespace rubicon::network
