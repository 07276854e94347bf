// What is to be seen of an ecology between two of its events.
#pragma once

#include "actors/supervision/ecology.hpp"
#include "core/time.hpp"
#include "report/history.hpp"

namespace rubicon {

/// Reads what the actors have, requests and changes nothing.
/// @pre no actor has its turn, and all have come to `now`
[[nodiscard]] report::run_sample look_at(const ecology_state& all, instant now);

/// Lets the ecology's watch look at its motes; the same, but for what the watch keeps.
void watch_time(ecology_state& all, instant now);

/// No battery is flat before this, by its use or by the fault plan; instant::max(): none ever is.
/// @pre as above
[[nodiscard]] instant batteries_last_until(const ecology_state& all, instant now);

} // namespace rubicon
