// Simulated Bluetooth between the machines of peers. Octets do not pass through here: the ends of a
// link send them to each other.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "actors/messages/links.hpp"
#include "config/plan/ecology.hpp"
#include "peis/media/simulated_bluetooth.hpp"

namespace rubicon {

struct peis_bluetooth_state {
  peis::simulated_bluetooth medium;
  std::map<peis::station_id, bluetooth_user_actor> users; ///< that run
  duration delay{};
  std::uint64_t rate_bps = 0; ///< of each link
};

peis_bluetooth_actor::behavior_type
peis_bluetooth(scheduler::actor_pointer<peis_bluetooth_state, peis_bluetooth_actor> self,
               const config::peis_description& network,
               const std::vector<config::bluetooth_device>& others);

} // namespace rubicon
