// What a program outside the ecology sends as one of a mote's.
#pragma once

#include <string>

#include "actors/messages/programs.hpp"
#include "actors/supervision/ecology.hpp"
#include "core/address.hpp"

namespace rubicon {

/// Gives the message to the mote, which sends it in this instant. @returns why it cannot; empty: it
/// can
[[nodiscard]] std::string send_as(const ecology_state& all, mote_address mote, send_as_program x);

} // namespace rubicon
