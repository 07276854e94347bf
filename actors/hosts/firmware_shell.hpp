// What a mote with firmware has in its actor.
#pragma once

#include <cstdint>
#include <memory>

#include "actors/base/timer.hpp"
#include "core/address.hpp"
#include "core/numbers/random.hpp"
#include "firmware/session.hpp"

namespace rubicon {

/// Set in the token of what firmware sends; those of others (network_radio.hpp, smepp_shell.hpp,
/// plain_host.hpp) and of flows do not have it.
inline constexpr std::uint64_t firmware_token = 1ULL << 60U;

struct firmware_shell {
  static constexpr std::uint8_t timer_number = 7;

  std::unique_ptr<firmware::session> runs;
  random_stream noise; ///< of its sensors
  position place;
  std::uint64_t sent = 0; ///< frames, for their tokens
  timer wake{timer_number};
  bool is_stopped = false;
};

} // namespace rubicon
