// A program that uses the Mockup interface, in an actor of its own beside its mote's (PAR-05).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "actors/base/timer.hpp"
#include "actors/island/program_host.hpp"
#include "actors/messages/programs.hpp"
#include "actors/messages/supervision.hpp"
#include "communication/remote_process.hpp"
#include "mote/crystal.hpp"

namespace rubicon {

/// What such an actor is made of, the same in all its lives.
struct program_arguments {
  std::string mote;       ///< `kitchen/climate-7`
  std::size_t number = 1; ///< among the mote's programs
  apps::app_config config;
  mote::crystal crystal;  ///< the mote's: the program lives in its time
  std::uint64_t seed = 0; ///< of the ecology
  ecology_actor ecology;
};

struct program_state {
  std::shared_ptr<const program_arguments> arguments;
  std::uint32_t incarnation = 0;                          ///< how often it was started before
  mote_actor mote;                                        ///< nullptr: it is out of order
  std::unique_ptr<communication::remote_process> process; ///< nullptr: the mote has not attached it
  program_host programs;
  bool is_over = false; ///< the mote's battery is flat
  timer wake;
};

/// Begins, as a program in the mote would, whenever its mote has attached it; is forgotten when its
/// mote fails. With the mote's seed it draws what it would draw in the mote.
/// @param arguments not nullptr
/// @param incarnation how often it was started before
program_actor::behavior_type
program_behavior(scheduler::actor_pointer<program_state, program_actor> self,
                 std::shared_ptr<const program_arguments> arguments, std::uint32_t incarnation);

} // namespace rubicon
