// What stands for the cable of an island whose sink is a real one.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "actors/base/timer.hpp"
#include "actors/messages/serial.hpp"
#include "actors/messages/supervision.hpp"
#include "actors/serial/sink_access.hpp"
#include "serial/reopening.hpp"

namespace rubicon {

struct outside_line_arguments {
  sink_access_config access;
  io::loop* loop = nullptr; ///< must outlive the actor
  island_id island;
  ecology_actor ecology;
};

struct outside_line_state {

  outside_line_arguments arguments;
  std::unique_ptr<sink_access> access;
  serial_end_actor pc;        ///< empty until attached
  line_watcher_actor watcher; ///< the same
  bool gives_octets = false;  ///< to the watcher, not to `pc`
  serial::reopening reopening;
  std::optional<instant> next_try;
  bool there = false;
  bool plugged = true;
  std::string told; ///< why it is not there
  std::uint64_t up = 0;
  std::uint64_t down = 0;
  std::uint64_t unheard = 0;   ///< octets that have come to no end
  std::uint64_t unplugged = 0; ///< octets for a sink that was not there
  std::uint64_t overflow = 0;  ///< octets for which there was no room
  timer wake;
};

/// Opens it, and opens it again when it is lost, until the actor ends. What goes wrong is told
/// once, not at each attempt.
outside_line_actor::behavior_type
outside_line(scheduler::actor_pointer<outside_line_state, outside_line_actor> self,
             outside_line_arguments arguments);

} // namespace rubicon
