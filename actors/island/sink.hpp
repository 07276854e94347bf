// A sink: the mote on the serial cable.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "actors/base/timer.hpp"
#include "actors/hosts/flow_host.hpp"
#include "actors/messages/air.hpp"
#include "actors/messages/programs.hpp"
#include "actors/messages/serial.hpp"
#include "actors/messages/supervision.hpp"
#include "mote/crystal.hpp"
#include "mote/sink.hpp"
#include "serial/mote_port.hpp"
#include "tinyos/base_station.hpp"

namespace rubicon {

/// A serial line of a sink, to a gateway of its own.
struct sink_line {
  serial_line_actor line;
  serial::mote_port_config port;
};

/// The backbone to a further sink.
struct sink_backbone {
  mote_id to;
  backbone_actor link;
};

/// What a sink actor is made of.
struct sink_arguments {
  mote_address address;
  network::router_config network; ///< sizes of tables
  mote::registrar_config registrar;
  radio::radio_index radio;
  air_actor air;
  bool is_base_station = false; ///< then no mote joins it: tables, clock and members mean nothing
  std::vector<sink_line> lines; ///< at least one, in the order in which gateways take over
  std::vector<sink_backbone> backbones;
  std::vector<config::mote_app> apps; ///< that measure
  mote::crystal crystal;              ///< ahead by what the clock of this life shows, once it runs
  mote::duty_config duty;
  std::chrono::milliseconds tick{500}; ///< period of the RUBICON clock
  std::uint64_t seed = 0;              ///< of the ecology
  ecology_actor ecology;
};

struct sink_state {
  sink_arguments arguments;
  mote::sink sink;
  std::unique_ptr<tinyos::base_station> base; ///< instead of it, if it is one
  std::string life;                           ///< its path, and from the second on its number
  std::vector<serial::mote_port> ports;       ///< of the lines
  flow_host flows;
  timer wake;
};

/// What its ends of the lines have counted.
[[nodiscard]] report::serial_report counted(const sink_state& x);

/// @param store as earlier lives have written it
sink_actor::behavior_type sink(scheduler::actor_pointer<sink_state, sink_actor> self,
                               sink_arguments arguments, mote::nonvolatile store);

} // namespace rubicon
