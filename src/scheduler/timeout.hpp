// What is to happen at a time.
#pragma once

#include <cstdint>

#include <caf/actor_control_block.hpp>

#include "core/account/provenance.hpp"
#include "core/time.hpp"
#include "scheduler/messages/envelope.hpp"

namespace rubicon::scheduler {

/// A message for an actor of ours, or its first turn.
struct timeout {
  caf::strong_actor_ptr receiver = {};
  envelope_ptr content = {};         ///< nullptr: it was spawned for another process, and begins
  caf::strong_actor_ptr sender = {}; ///< an actor of ours, or nobody
  std::uint64_t number = 0;          ///< of a message that may be moved; 0: it may not
  provenance from = {};
};

/// What another thread may ask of the clock.
struct add_timeout {
  instant due;
  timeout what;
};

} // namespace rubicon::scheduler
