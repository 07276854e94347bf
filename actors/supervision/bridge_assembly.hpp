// The part of the assembly between motes and gateways: sinks, their lines and backbones.
#pragma once

#include <chrono>

#include "actors/messages/air.hpp"
#include "actors/supervision/assembly.hpp"
#include "config/plan/ecology.hpp"
#include "serial/cable/backbone_config.hpp"

namespace rubicon {

/// How far the age of a packet may be wrong.
[[nodiscard]] std::chrono::microseconds doubt_of(const serial::backbone_config& x);

/// The backbones of the further sinks of an island; before these.
void spawn_backbones(ecology_pointer self, const config::island_description& island);

/// The line to the real sink of an island, and its gateway.
void spawn_outside(ecology_pointer self, const config::island_description& island);

/// The serial lines, sink and gateways of an island; or its sink alone, if it only measures.
void spawn_bridge(ecology_pointer self, const config::island_description& island,
                  radio::radio_index radio, const air_actor& air);

} // namespace rubicon
