// Whether an island's motes have room for what they send: in their common windows where radios
// sleep (NRG-01), in the air around the sink where they do not.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "config/plan/ecology.hpp"
#include "core/time.hpp"
#include "radio/parameters.hpp"

namespace rubicon::config {

/// How many of the longest beacons, of radios that all hear each other, follow one another in the
/// part of a window in which frames may begin.
[[nodiscard]] std::size_t beacons_in(duration window);

/// The shortest window, in steps of 10 ms, with room for so many.
[[nodiscard]] duration window_for(std::size_t beacons);

/// How far all radios reach, where that alone decides. [m]
[[nodiscard]] std::optional<double> range_of(const radio::channel_config& x);

/// From each mote to the sink, 1 at least. @param range_m nothing: all are next to it
[[nodiscard]] std::vector<unsigned> hops_to_sink(const island_description& x,
                                                 std::optional<double> range_m);

/// How many motes share the air around one of them, or the sink: those that it hears without
/// shadowing, itself included. Of large islands the sink and some of the motes are looked at.
[[nodiscard]] std::size_t crowd_of(const island_description& x, const radio::channel_config& radio);

/// Messages that the programs of a mote, or of an island, send to the sink; reliable ones are two,
/// since they are acknowledged end to end. [1/s]
[[nodiscard]] double messages_per_second(const mote_description& x, double reliable_weight = 2);
[[nodiscard]] double messages_per_second(const island_description& x);

/// Packets between motes and their sink in one window, weighted by what they cost: of reliable
/// messages and of streams to other islands and PCs also those that come back.
[[nodiscard]] double packets_per_window(const island_description& x);

/// How many of them a window carries with hardly a loss. Measured with lines of 1 to 8 hops
/// (docs/radio.md). @param loss of frames, 0..1
[[nodiscard]] double packets_in(duration window, unsigned hops, double loss);

/// The shortest window, in steps of 10 ms, that carries so many.
[[nodiscard]] duration window_for(double packets, unsigned hops, double loss);

/// What the radio of one sink carries, when all its motes are in its reach. Measured with stars of
/// 60 to 254 motes (docs/radio.md). [1/s]
inline constexpr double sink_carries = 85;

/// What is to be said of a window that is too short for those that share it; empty: nothing.
[[nodiscard]] std::string warning_of_window(const island_description& x,
                                            const radio::channel_config& radio);

/// The same of an island whose motes send more than the radio of its sink carries.
[[nodiscard]] std::string warning_of_traffic(const island_description& x);

} // namespace rubicon::config
