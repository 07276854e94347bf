// Whether an island's radios can listen at low power, and have time for what its file asks of them.
#pragma once

#include <optional>
#include <string>

#include "config/plan/ecology.hpp"
#include "config/toml/problem.hpp"
#include "radio/parameters.hpp"

namespace rubicon::config {

/// What an island needs of the air that its motes share, by the rates that its file asks for: a
/// message or synaptic vector takes half an interval on average at each hop to a mote whose radio
/// sleeps, and a broadcast a whole one.
struct air_need {
  double hops_per_second = 0;       ///< of both, to motes whose radios sleep
  double broadcasts_per_second = 0; ///< by which the island keeps its time
  double share = 0;                 ///< of the time that both take; above 1 there is not so much
};

/// @param range_m how far radios reach; nothing: all motes are next to the sink
/// @param tick after which vectors come again
[[nodiscard]] air_need air_need_of(const island_description& x, std::optional<double> range_m,
                                   duration tick);

/// What is to be said of an interval that is too long for that; empty: nothing.
[[nodiscard]] std::string warning_of_interval(const island_description& x,
                                              const radio::channel_config& radio, duration tick);

/// Refuses what cannot be, and warns of an interval that is too long.
/// @param at of the interval @pre x.listening.enabled()
void check_listening(const island_description& x, const radio::channel_config& radio, duration tick,
                     const mark& at, complaints& problems);

} // namespace rubicon::config
