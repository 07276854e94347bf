// What supervisors say of an actor that has ended.
#pragma once

#include <string>
#include <string_view>

#include <caf/error.hpp>
#include <caf/exit_reason.hpp>

namespace rubicon {

/// What ends a mote or sink whose crash the fault plan asks for.
inline constexpr std::string_view planned_crash = "crash from the fault plan";

/// The text of the exception that ended an actor, or what else its reason says.
[[nodiscard]] inline std::string text_of(const caf::error& reason) {
  if (!reason)
    return "ended without being asked";
  if (reason.context().match_elements<std::string>())
    return reason.context().get_as<std::string>(0);
  return caf::to_string(reason);
}

/// Whether it ended because somebody wanted it to.
[[nodiscard]] inline bool was_asked_to_end(const caf::error& reason) {
  return reason == caf::exit_reason::user_shutdown;
}

} // namespace rubicon
