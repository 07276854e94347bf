// A proxy: speaks for one mote, through tuples only.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "actors/base/timer.hpp"
#include "actors/island/program_host.hpp"
#include "actors/messages/peis.hpp"
#include "actors/messages/programs.hpp"
#include "actors/messages/services.hpp"
#include "actors/messages/supervision.hpp"
#include "apps/streams/stream_tap.hpp"
#include "communication/remote_process.hpp"
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
  program_node_actor layer = {};      ///< of its peer; nullptr: its class reads no streams
  std::string peer_name = {};
};

/// The read ends of a proxy's streams, in the Communication Layer of its peer (PXY-18).
struct proxy_streams {
  std::unique_ptr<communication::remote_process> process; ///< nullptr: not attached
  program_host programs;
  apps::stream_tap* tap = nullptr; ///< among these
};

struct proxy_actor_state {
  proxy_arguments arguments;
  std::vector<proxy::watch> watches; ///< watch n has the name n + 1
  std::uint64_t failed_writes = 0;   ///< to the gateway; the core's timeout notifies its user
  peer_id written_to = any_peer;     ///< the gateway whose answers count
  proxy_streams streams;
  timer wake;
};

proxy_actor::behavior_type
proxy_behavior(scheduler::actor_pointer<proxy_actor_state, proxy_actor> self,
               proxy_arguments arguments);

} // namespace rubicon
