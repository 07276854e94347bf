// The Communication Layer of a peer, and the programs that use it.
#pragma once

#include <string>
#include <vector>

#include "actors/base/timer.hpp"
#include "actors/island/program_host.hpp"
#include "actors/island/separate_programs.hpp"
#include "actors/messages/peis.hpp"
#include "actors/messages/services.hpp"
#include "actors/messages/supervision.hpp"
#include "communication/pc.hpp"
#include "gateway/others/alias_talks.hpp"
#include "gateway/others/directory.hpp"

namespace rubicon {

struct pc_arguments {
  communication::pc_config config;
  bool aliases =
      false;        ///< some islands have several gateways: it is notified which one leads (GW-14)
  std::string name; ///< the peer's
  std::vector<apps::app_config> programs;
  std::uint64_t seed = 0; ///< of the ecology
  peis_peer_actor peer;
  ecology_actor ecology;
};

struct pc_state {
  pc_arguments arguments;
  communication::pc pc;
  gateway::directory gateways; ///< empty without aliases
  gateway::alias_talks talks;
  program_host programs;
  separate_programs separate; ///< of proxies
  timer wake;
};

pc_actor::behavior_type pc(scheduler::actor_pointer<pc_state, pc_actor> self,
                           pc_arguments arguments);

} // namespace rubicon
