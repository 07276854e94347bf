// The PC's end of a simulated cable, where other programs find it: a pseudo-terminal.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "actors/messages/serial.hpp"
#include "actors/messages/supervision.hpp"
#include "io/serial/pseudo_terminal.hpp"

namespace rubicon {

struct pty_end_arguments {
  std::string link;          ///< where they find it
  std::size_t buffer = 4096; ///< octets that may wait for one that does not read
  io::loop* loop = nullptr;  ///< must outlive the actor
  island_id island;
  serial_line_actor line;
  ecology_actor ecology;
};

struct pty_end_state {

  pty_end_arguments arguments;
  std::optional<io::pseudo_terminal> pty; ///< nothing: it could not be had
  bool attached = false;
  std::uint64_t absent = 0; ///< octets for nobody
  std::uint64_t slow = 0;   ///< octets for one that did not read those before
};

pty_end_actor::behavior_type pty_end(scheduler::actor_pointer<pty_end_state, pty_end_actor> self,
                                     pty_end_arguments arguments);

} // namespace rubicon
