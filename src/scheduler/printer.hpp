// Where CAF's own complaints go.
#pragma once

#include <caf/actor.hpp>
#include <caf/fwd.hpp>

namespace rubicon::scheduler {

/// Takes the place of CAF's printing thread: what actors write to caf::aout, such as an exception
/// that no handler takes or a message that nobody expects, goes to stderr at once, line by line.
[[nodiscard]] caf::actor make_printer(caf::actor_system& system);

} // namespace rubicon::scheduler
