// The simulated network between the hosts of peers. Octets do not pass through here: the ends of a
// link send them to each other, in the condition that they are sent.
#pragma once

#include <cstdint>
#include <map>

#include "actors/messages/links.hpp"
#include "config/plan/ecology.hpp"
#include "peis/media/simulated_lan.hpp"

namespace rubicon {

struct peis_lan_state {
  peis::simulated_lan lan;
  std::map<peis::station_id, lan_user_actor> users; ///< that run
  duration delay{};
};

/// @param seed of the ecology
peis_lan_actor::behavior_type
peis_lan(scheduler::actor_pointer<peis_lan_state, peis_lan_actor> self,
         const config::peis_description& network, std::uint64_t seed);

} // namespace rubicon
