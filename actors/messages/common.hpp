// What all kinds of actors share.
#pragma once

#include <cstdint>
#include <string>

#include "core/describe/fields.hpp"
#include "core/time.hpp"
#include "scheduler/actor.hpp"

namespace rubicon {

using scheduler::extends;
using scheduler::post;
using scheduler::post_after;
using scheduler::post_exit;
using scheduler::ref;
using scheduler::takes;

/// The handle of an actor, from inside of it.
template <class Handle, class Self>
[[nodiscard]] Handle handle_of(Self* self) {
  return self->template handle<typename Handle::interface>();
}

/// A timer of one actor has run down. `epoch` tells an outdated expiry from the awaited one,
/// `which` tells the timers of one actor apart.
struct timer_expired {
  std::uint8_t which = 0;
  std::uint64_t epoch = 0;
};
RUBICON_FIELDS(timer_expired, which, epoch);

/// To everybody at the end of a run: report what you know to the ecology. Or, to sinks, motes and
/// programs in between, to tell what is judged in the course of the run (sample_status).
struct status_request {
  std::uint64_t sample = 0; ///< its number; 0: the whole report
};
RUBICON_FIELDS(status_request, sample);

/// Something a person following the run would want to hear.
struct notable_event {
  std::string who; ///< actor path
  std::string what;
};
RUBICON_FIELDS(notable_event, who, what);

/// From a supervisor below the ecology: an actor of its own has failed, whether or not it starts it
/// again.
struct actor_failed {
  std::string who; ///< actor path
  std::string why;
};
RUBICON_FIELDS(actor_failed, who, why);

/// Something that the file asks for cannot be had. It is a violation of the run.
struct request_unmet {
  std::string who;       ///< actor path
  std::string what;      ///< with the reason, and what to do
  bool ends_run = false; ///< nothing of what follows would be what was asked for
};
RUBICON_FIELDS(request_unmet, who, what, ends_run);

/// From the fault plan: the clock of a mote, sink or kernel is set.
struct step_clock {
  duration by{};
};
RUBICON_FIELDS(step_clock, by);

} // namespace rubicon
