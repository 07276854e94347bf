// Logs of a run: one line an event on standard error.
#pragma once

#include <string>

#include "cli/print/console.hpp"

namespace rubicon::cli {

/// Actors log through spdlog's default logger: this sets its level and form, `W text`. On a
/// terminal a line takes the place of a progress bar that stands there.
/// @pre `level` is trace, debug, info, warn, error or off
void set_up_logging(const std::string& level, const console& errors);

} // namespace rubicon::cli
