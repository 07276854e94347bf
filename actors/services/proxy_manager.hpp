// The proxy manager of a basestation: starts a proxy for every mote that needs one.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "actors/base/timer.hpp"
#include "actors/messages/peis.hpp"
#include "actors/messages/programs.hpp"
#include "actors/messages/services.hpp"
#include "actors/messages/supervision.hpp"
#include "config/plan/ecology.hpp"
#include "proxy/gateway_choice.hpp"
#include "proxy/manager.hpp"

namespace rubicon {

/// A gateway that perceives the motes of an island.
struct managed_gateway {
  peer_id id;
  std::string name;
};

/// An island whose gateways the manager listens to, and the names that its tuples shall show.
struct managed_island {
  island_id id;
  std::string name;
  std::map<mote_id, std::string> mote_names;
  std::vector<managed_gateway> gateways = {}; ///< in the order in which they take over; empty: the
                                              ///< one with the island's id, of unknown name
  std::optional<position> sink_place = {};    ///< where their antenna is
  duration slack = {}; ///< what outcomes of a gateway take longer, as radios of motes sleep
};

/// What a proxy manager actor is made of.
struct proxy_manager_arguments {
  std::vector<proxy::proxy_class> classes;
  std::vector<managed_island> islands;
  peer_id peer_number;
  peis_peer_actor peer;
  ecology_actor ecology;
  program_node_actor layer = {}; ///< of the peer; nullptr: no class reads streams
  std::string peer_name = {};
};

struct proxy_manager_state {
  proxy_manager_arguments arguments;
  proxy::manager manager;
  std::map<island_id, proxy::gateway_choice> gateways;
  std::map<mote_address, proxy_actor> proxies;
  std::map<std::string, mote_address> keys; ///< what theirs begin with, in small letters
  timer classes_wake;
};

proxy_manager_actor::behavior_type
proxy_manager(scheduler::actor_pointer<proxy_manager_state, proxy_manager_actor> self,
              proxy_manager_arguments arguments);

} // namespace rubicon
