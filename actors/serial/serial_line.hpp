// The cable between a sink and its gateway.
#pragma once

#include <array>

#include "actors/base/timer.hpp"
#include "actors/messages/serial.hpp"
#include "actors/messages/supervision.hpp"
#include "serial/cable/line.hpp"

namespace rubicon {

struct serial_line_state {
  serial::line line;
  std::array<serial_end_actor, 2> ends; ///< by serial::direction, empty until attached
  std::uint64_t unheard = 0;            ///< octets that have come to no end
  duration latency{};                   ///< of the adapter at the PC's end
  island_id island;
  ecology_actor ecology;
  timer wake;
};

/// What it has carried and lost.
[[nodiscard]] report::serial_report counted(const serial_line_state& x);

/// What has arrived at the PC's end gets there after the adapter's latency; whoever writes there
/// delays it as long.
/// @param latency of the adapter
serial_line_actor::behavior_type
serial_line(scheduler::actor_pointer<serial_line_state, serial_line_actor> self, serial::line line,
            duration latency, island_id island, ecology_actor ecology);

} // namespace rubicon
