// A serial forwarder beside a gateway, for programs of TinyOS (tinyos.md 2).
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "actors/messages/serial.hpp"
#include "actors/messages/services.hpp"
#include "actors/messages/supervision.hpp"
#include "actors/serial/forwarder_clients.hpp"

namespace rubicon {

struct forwarder_server_arguments {
  std::string where; ///< ADDRESS:PORT
  std::vector<ipv4_network> networks;
  io::loop* loop = nullptr; ///< must outlive the actor
  island_id island;
  ecology_actor ecology;
};

struct forwarder_server_state {

  forwarder_server_arguments arguments;
  std::unique_ptr<forwarder_clients> clients; ///< nullptr: it could not listen
  packet_end_actor sink;                      ///< empty until attached
};

/// A serial_packet of the gateway has the token 0.
forwarder_server_actor::behavior_type
forwarder_server(scheduler::actor_pointer<forwarder_server_state, forwarder_server_actor> self,
                 forwarder_server_arguments arguments);

} // namespace rubicon
