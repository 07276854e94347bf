// What the computer's clock shows, in its zone.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "proxy/rules/rules_config.hpp"

namespace rubicon::cli {

/// Since midnight, to the second.
[[nodiscard]] duration time_of_day(std::chrono::system_clock::time_point at);

/// What the clock shows now: `12:04:59`, with milliseconds `12:04:59.300`.
[[nodiscard]] std::string clock_now(bool milliseconds);

/// When the clock will leap within `length`, in time since `begin`, to the second.
[[nodiscard]] std::vector<proxy::clock_change>
clock_changes(std::chrono::system_clock::time_point begin, duration length);

} // namespace rubicon::cli
