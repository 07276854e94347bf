// A recording of a serial line in the place of the cable.
#pragma once

#include <cstdint>

#include "actors/base/timer.hpp"
#include "actors/messages/serial.hpp"
#include "actors/messages/supervision.hpp"
#include "serial/recording.hpp"

namespace rubicon {

struct replay_line_state {

  serial::replay replay;
  island_id island;
  ecology_actor ecology;
  serial_end_actor pc;        ///< empty until attached
  line_watcher_actor watcher; ///< the same
  bool gives_octets = false;  ///< to the watcher, not to `pc`
  bool plugged = true;
  std::uint64_t up = 0;
  std::uint64_t down = 0;
  std::uint64_t unheard = 0;   ///< octets that have come to no end
  std::uint64_t unplugged = 0; ///< octets lost because no cable was there
  timer wake;
};

serial_line_actor::behavior_type
replay_line(scheduler::actor_pointer<replay_line_state, serial_line_actor> self,
            serial::replay replay, island_id island, ecology_actor ecology);

} // namespace rubicon
