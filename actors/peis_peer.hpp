// One PEIS kernel, its links to other kernels, and the components that use it.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "actors/messages.hpp"
#include "actors/timer.hpp"
#include "peis/kernel.hpp"

namespace rubicon {

/// What a peer actor is made of.
struct peis_peer_arguments {
  peis::kernel_config config;
  std::string name;
  std::uint64_t seed = 0; ///< of the ecology
  ecology_actor ecology;
};

/// How long octets take over an in-process link: that of a switched LAN [estimate].
inline constexpr duration inproc_delay = 200us;

struct peis_peer_state {
  /// Who hears of a subscription or a request, and under which name of its own.
  struct interest {
    peis_client_actor client;
    std::uint64_t name = 0;
  };

  peis_peer_arguments arguments;
  peis::kernel kernel;
  std::map<peis::link_id, link_end_actor> links;
  std::map<peis::subscription_id, interest> watches;
  std::map<peis::request_id, interest> requests;
  std::map<std::uint16_t, peis_client_actor> ports;
  std::set<caf::actor_addr> clients; ///< monitored: one that ends leaves nothing behind
  std::uint64_t next_watch = 1;
  std::uint64_t next_request = 1;
  timer wake;
};

peis_peer_actor::behavior_type
peis_peer(scheduler::traced_pointer<peis_peer_state, peis_peer_actor> self,
          peis_peer_arguments arguments);

} // namespace rubicon
