// Whether the common windows of an island whose radios sleep have room for its motes (NRG-01).
#pragma once

#include <cstddef>
#include <string>

#include "config/ecology.hpp"
#include "core/time.hpp"
#include "radio/parameters.hpp"

namespace rubicon::config {

/// How many of the longest beacons, of radios that all hear each other, follow one another in the
/// part of a window in which frames may begin.
[[nodiscard]] std::size_t beacons_in(duration window);

/// The shortest window, in steps of 10 ms, with room for so many.
[[nodiscard]] duration window_for(std::size_t beacons);

/// How many motes share the air around one of them, or the sink: those that it hears without
/// shadowing, itself included. Of large islands the sink and some of the motes are looked at.
[[nodiscard]] std::size_t crowd_of(const island_description& x, const radio::channel_config& radio);

/// Messages that the programs of an island send to its sink in one period of its windows.
[[nodiscard]] double messages_in_period(const island_description& x);

/// What is to be said of a window that is too short for those that share it; empty: nothing.
[[nodiscard]] std::string doubt_of_window(const island_description& x,
                                          const radio::channel_config& radio);

} // namespace rubicon::config
