// The simulated network between the hosts of peers: who can be reached, which links are open, and
// what goes wrong. Octets do not pass through here: the ends of a link send them to each other, in
// the condition that they are told.
#pragma once

#include <cstdint>
#include <map>
#include <set>

#include "actors/messages.hpp"
#include "config/ecology.hpp"
#include "core/random.hpp"

namespace rubicon {

struct peis_lan_state {
  /// A process on a computer. It stays here after its end as long as somebody has a link to it.
  struct station {
    peer_id id;
    lan_user_actor user; ///< nullptr: the process has ended
    bool hears = true;
    bool powered = true;
  };

  struct link {
    std::uint64_t initiator = 0; ///< stations
    std::uint64_t acceptor = 0;
    link_condition condition; ///< as the ends have been told
  };

  struct fault {
    std::map<peer_id, std::size_t> groups; ///< empty: no partition
    std::size_t rest = 0;                  ///< the group of those in none
    double loss = 0;
    std::set<peer_id> lossy; ///< empty: all
  };

  config::peis_description network;
  random_stream rng;
  std::map<std::uint64_t, station> stations;
  std::map<std::uint64_t, link> links;
  std::map<std::uint64_t, fault> faults;
  std::uint64_t next_link = 1;
};

/// @param seed of the ecology
peis_lan_actor::behavior_type
peis_lan(scheduler::traced_pointer<peis_lan_state, peis_lan_actor> self,
         config::peis_description network, std::uint64_t seed);

} // namespace rubicon
