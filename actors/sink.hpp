// A sink: the mote on the serial cable.
#pragma once

#include <cstdint>
#include <vector>

#include "actors/flow_host.hpp"
#include "actors/messages.hpp"
#include "actors/timer.hpp"
#include "mote/crystal.hpp"
#include "mote/sink.hpp"
#include "serial/mote_port.hpp"

namespace rubicon {

/// What a sink actor is made of.
struct sink_arguments {
  mote_address address;
  mote::registrar_config registrar;
  serial::mote_port_config port;
  radio::radio_index radio;
  air_actor air;
  serial_line_actor line;
  std::vector<config::mote_app> apps; ///< that measure
  mote::crystal crystal;
  mote::duty_config duty;
  std::uint64_t seed = 0; ///< of the ecology
  ecology_actor ecology;
};

struct sink_state {
  sink_arguments arguments;
  mote::sink sink;
  serial::mote_port port;
  flow_host flows;
  timer wake;
};

sink_actor::behavior_type sink(scheduler::traced_pointer<sink_state, sink_actor> self,
                               sink_arguments arguments);

} // namespace rubicon
