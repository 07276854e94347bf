// The part of a proxy manager that starts a proxy for every tagged object a class claims.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "actors/base/timer.hpp"
#include "actors/messages/peis.hpp"
#include "actors/messages/services.hpp"
#include "actors/messages/supervision.hpp"
#include "proxy/object_manager.hpp"

namespace rubicon {

struct object_manager_state {

  using object = std::pair<std::string, std::string>; ///< channel and hardware id

  static constexpr std::uint8_t classes_timer = 1;

  std::vector<proxy::proxy_class> classes; ///< those not known yet as well
  proxy::object_manager manager;
  std::map<object, timed_peer_app_actor> proxies;
  std::set<object> ended; ///< proxies that have, until they are started again
  std::optional<instant> restart_at;
  std::string peer_name; ///< in the report
  peis_peer_actor peer;
  ecology_actor ecology;
  timer wake;
  timer classes_wake{classes_timer};
};

timed_peer_app_actor::behavior_type
object_manager(scheduler::actor_pointer<object_manager_state, timed_peer_app_actor> self,
               std::vector<proxy::proxy_class> classes, std::string peer_name, peis_peer_actor peer,
               ecology_actor ecology);

} // namespace rubicon
