// A proxy: speaks for one mote, through tuples only.
#pragma once

#include <string>
#include <vector>

#include "actors/messages.hpp"
#include "actors/timer.hpp"
#include "proxy/proxy.hpp"

namespace rubicon {

/// What a proxy actor is made of.
struct proxy_arguments {
  proxy::proxy core;
  peer_id peer_number; ///< of the kernel it uses
  peis_peer_actor peer;
  ecology_actor ecology;
  std::vector<peer_id> gateways = {}; ///< of the mote's island; empty: the one with its id
  peer_id gateway = any_peer;         ///< of them, the one that leads it
};

struct proxy_actor_state {
  proxy_arguments arguments;
  std::vector<proxy::watch> watches; ///< watch n has the name n + 1
  std::uint64_t failed_writes = 0;   ///< to the gateway; the core's timeout tells its user
  peer_id written_to = any_peer;     ///< the gateway whose answers count
  timer wake;
};

proxy_actor::behavior_type
proxy_behavior(scheduler::traced_pointer<proxy_actor_state, proxy_actor> self,
               proxy_arguments arguments);

} // namespace rubicon
