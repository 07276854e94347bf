// How a supervisor learns that an actor has failed.
//
// What CAF 0.17.6 does when a handler, or the behaviour function itself, throws:
// - The actor's exception handler turns the exception into a caf::error; the actor quits with that
//   error as its reason. Its state is destroyed, what is in its mailbox is dropped, requests
//   waiting there or in hand are answered with an error. Other actors are not touched.
// - The default exception handler prints to caf::aout, thus to stderr, and gives sec::runtime_error
//   without text. With a handler of one's own nothing is printed.
// - Whoever monitors the actor gets one down_msg{source, reason}. A monitor without down handler
//   prints "unhandled down message". A link instead of a monitor ends the partner too.
// - The reason of an actor that quits in good order is the empty error, or an exit_reason.
// - A state constructor that throws does so out of spawn(), before there is an actor.
//
// So a supervisor sets a down handler, spawns with `spawn_at<caf::monitored>`, and finds the failed
// child by `handle.address() == down.source`; it may spawn the next at the same path from inside
// the down handler.
#pragma once

#include <exception>

#include <caf/error.hpp>
#include <caf/scheduled_actor.hpp>

namespace rubicon::scheduler {

/// sec::runtime_error with the exception's text, which `caf::to_string(reason)` of whoever gets the
/// down_msg shows.
[[nodiscard]] caf::error failure_of(const std::exception_ptr& x);

/// Makes an exception in any handler of the actor end it in silence, with failure_of() as the
/// reason its monitors are told. Stands first in a behaviour function; only for actors that are
/// monitored.
void tell_monitors_of_exceptions(caf::scheduled_actor* self);

} // namespace rubicon::scheduler
