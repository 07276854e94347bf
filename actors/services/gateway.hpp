// The gateway of one island: a component of a PEIS kernel on one side, the serial line on the
// other; and the programs of its PC.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "actors/base/timer.hpp"
#include "actors/island/program_host.hpp"
#include "actors/messages/peis.hpp"
#include "actors/messages/serial.hpp"
#include "actors/messages/services.hpp"
#include "actors/messages/supervision.hpp"
#include "gateway/gateway.hpp"
#include "gateway/plain/plain_line.hpp"
#include "serial/host_port.hpp"

namespace rubicon {

/// What a gateway actor is made of.
struct gateway_arguments {
  gateway::gateway_config config;
  std::string name;        ///< of its kernel
  peer_id self = any_peer; ///< the same; any_peer: it has the island's id
  std::vector<apps::app_config> programs;
  gateway::plain_line_config plain; ///< with a range where there is a real_line
  serial::host_port_config port;
  serial::host_port_config real_port;
  std::uint64_t seed = 0; ///< of the ecology
  peis_peer_actor peer;   ///< the kernel whose component it is
  serial_line_actor line;
  bool line_is_real = false;        ///< its adapter takes its time by itself
  bool may_be_own_sink = false;     ///< once it has said so, port.payload_max is too little
  serial_line_actor real_line;      ///< to motes with plain programs; nullptr: they are at `line`
  forwarder_server_actor forwarder; ///< for programs of TinyOS; nullptr: none
  ecology_actor ecology;
};

struct gateway_state {
  gateway_arguments arguments;
  gateway::gateway gateway;
  gateway::plain_line plain;
  serial::host_port port;
  serial::host_port real_port;
  std::uint64_t next_packet = 1;
  std::uint64_t bad_packets = 0;   ///< from the line, not serial active messages
  std::uint64_t messages_lost = 0; ///< that another gateway did not acknowledge
  bool has_refused = false;        ///< a packet too long for the mote at a line, and has said so
  std::map<serial::packet_id, std::uint64_t> foreign; ///< of programs of TinyOS: their tokens
  std::map<serial::packet_id, std::uint64_t> inputs;  ///< for plain motes: to_plain::number
  program_host programs;
  timer wake;
};

/// What its end of the line to the sink has counted.
[[nodiscard]] report::serial_report counted(const gateway_state& x);

gateway_actor::behavior_type
gateway_behavior(scheduler::actor_pointer<gateway_state, gateway_actor> self,
                 gateway_arguments arguments);

} // namespace rubicon
