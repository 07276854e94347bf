// The peisinit of a host: runs the components there, and lets other peers start and stop them by
// tuples.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "actors/base/timer.hpp"
#include "actors/messages/peis.hpp"
#include "actors/messages/services.hpp"
#include "actors/messages/supervision.hpp"
#include "io/files/file_lock.hpp"
#include "io/process/process.hpp"
#include "peisinit/supervisor.hpp"

namespace rubicon {

/// What an init actor is made of.
struct init_arguments {
  std::string name; ///< of its peer
  peer_id id;       ///< of its peer
  std::vector<peisinit::component> components;
  io::loop* loop = nullptr; ///< where processes are; nullptr: there are none, as in virtual time
  std::string lock;         ///< path of the file that only one may hold; empty: one of the host
  peis_peer_actor peer;
  ecology_actor ecology;
};

struct init_state {
  init_arguments arguments;
  peisinit::supervisor supervisor;
  std::optional<peisinit::host_facts> host; ///< known once the kernel is guarded
  std::optional<io::file_lock> lock;
  std::map<std::size_t, io::process> processes; ///< by component
  std::set<std::size_t> unmet;                  ///< components that are not to start
  bool quit_wanted = false;                     ///< before the host was known
  timer wake;
};

/// Fails if another init has the host.
init_actor::behavior_type init_behavior(scheduler::actor_pointer<init_state, init_actor> self,
                                        init_arguments arguments);

} // namespace rubicon
