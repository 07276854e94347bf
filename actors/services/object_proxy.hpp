// A proxy of a tagged object: what interfaces perceive of it, in tuples that everybody understands.
#pragma once

#include <string>

#include "actors/base/timer.hpp"
#include "actors/messages/peis.hpp"
#include "actors/messages/services.hpp"
#include "actors/messages/supervision.hpp"
#include "proxy/object_proxy.hpp"

namespace rubicon {

struct object_proxy_state {

  proxy::object_proxy core;
  std::string peer_name; ///< in the report
  peis_peer_actor peer;
  ecology_actor ecology;
  timer wake;
};

timed_peer_app_actor::behavior_type
object_proxy_behavior(scheduler::actor_pointer<object_proxy_state, timed_peer_app_actor> self,
                      proxy::object_proxy core, std::string peer_name, peis_peer_actor peer,
                      ecology_actor ecology);

} // namespace rubicon
