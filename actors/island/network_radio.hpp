// How the frames of a mote's or sink's Network module go through its radio.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>

#include "actors/messages/air.hpp"
#include "network/router.hpp"

namespace rubicon {

/// Set in the token of what Network sends, so that flows can use the other tokens.
inline constexpr std::uint64_t network_token = 1ULL << 63U;

[[nodiscard]] inline radio_send request_of(radio::radio_index radio, network::frame_out x) {
  const bool unicast = x.next_hop != broadcast_mote;
  return {radio,
          network_token | x.token,
          x.next_hop,
          x.am_type,
          payload(std::move(x.payload)),
          unicast,
          x.age_at ? static_cast<std::uint8_t>(*x.age_at) : no_age,
          x.in_slot};
}

/// Network's own token of a request that has ended; nothing if it was not Network's.
[[nodiscard]] inline std::optional<std::uint64_t> token_of(const radio_done& x) {
  if ((x.token & network_token) == 0)
    return std::nullopt;
  return x.token & ~network_token;
}

/// When the start-of-frame delimiter of a frame was on the air that has ended now.
[[nodiscard]] inline instant sfd_of(std::size_t psdu_size, instant now) {
  return now - (radio::air_time(psdu_size) - radio::sfd_delay);
}

/// When the start-of-frame delimiter of a frame was received that is complete now.
[[nodiscard]] inline instant sfd_of(byte_view psdu, instant now) {
  return sfd_of(psdu.size(), now);
}

} // namespace rubicon
