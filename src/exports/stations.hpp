// Names of the motes, sinks, gateways, peers and proxies at which the steps of a record take place.
#pragma once

#include <string>
#include <string_view>

#include "explain/traces.hpp"

namespace rubicon::exports {

/// Of an actor; a program belongs to its mote or peer. `kitchen/fan`, `kitchen/sink`, `care-pc`,
/// `proxy kitchen.fan`.
[[nodiscard]] std::string station_of(const explain::names& known, std::string_view path);

/// Of a step; of a hop: who sends.
[[nodiscard]] std::string station_of(const explain::traces& all, const explain::node& x);

} // namespace rubicon::exports
