// A frame that a router hands to the radio, or to a backbone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>

#include "core/account/provenance.hpp"
#include "core/address.hpp"
#include "core/bytes.hpp"

namespace rubicon::network {

/// What carries a frame.
enum class medium : std::uint8_t { radio, backbone };

/// The end of what has this token is not awaited.
inline constexpr std::uint64_t no_token = std::numeric_limits<std::uint64_t>::max();

/// Put this frame on the radio, or on the backbone that leads to next_hop, and notify on_sent() how
/// it ended.
struct frame_out {
  std::uint64_t token = 0; ///< no_token: not to be acknowledged, on a backbone
  mote_id next_hop;        ///< broadcast_mote: to all, not acknowledged
  std::uint8_t am_type = 0;
  bytes payload;
  std::optional<std::size_t> age_at; ///< as in radio::request; the next too
  bool in_slot = false;
  medium over = medium::radio;
  provenance from = {};
};

} // namespace rubicon::network
