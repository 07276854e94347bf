// Frames for a mac, and its steps from deadline to deadline.
#pragma once

#include <cstdint>

#include "radio/mac.hpp"

namespace rubicon::test {

inline constexpr std::size_t psdu_size = 41; // 28 octets of payload: followed by a LIFS

[[nodiscard]] inline radio::outgoing frame_of(std::uint64_t token, bool ack,
                                              std::size_t size = psdu_size) {
  radio::outgoing x;
  x.token = token;
  x.psdu = bytes(size);
  x.content.ack_request = ack;
  x.content.dsn = static_cast<std::uint8_t>(token);
  return x;
}

/// Steps a mac to its next deadline.
inline radio::mac_action step(radio::mac& x, instant& now, bool clear, random_stream& rng) {
  now = x.deadline().value();
  return x.on_time(now, clear, rng);
}

} // namespace rubicon::test
