// Control programs that run on robots and PCs. They know tuples and nothing else.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "actors/messages.hpp"
#include "actors/timer.hpp"
#include "config/ecology.hpp"
#include "proxy/rules.hpp"

namespace rubicon {

struct rules_state {
  proxy::rules rules;
  std::map<std::string, peer_id> owners; ///< of the tuples to write, as far as they are known
  peis_peer_actor peer;
  ecology_actor ecology;
  std::uint64_t failed_writes = 0;
  timer wake;
};

/// Watches tuples and writes others when conditions come to hold.
timed_peer_app_actor::behavior_type
rules_program(scheduler::traced_pointer<rules_state, timed_peer_app_actor> self, proxy::rules rules,
              peis_peer_actor peer, ecology_actor ecology);

struct collector_state {
  config::collector_app config;
  peis_peer_actor peer;
  ecology_actor ecology;
  std::set<std::string> collected; ///< `owner:key` of each tuple there is
  std::uint64_t updates = 0;
};

/// Subscribes to keys of any owner, and so has the kernel hold the newest value of each; counts
/// them, at most collected_max. Asks gateways for its period whenever they list a mote whose
/// outputs its keys name.
/// @param who its peer in the report
peer_app_actor::behavior_type
collector(scheduler::traced_pointer<collector_state, peer_app_actor> self,
          config::collector_app config, std::string who, peis_peer_actor peer,
          ecology_actor ecology);

inline constexpr std::size_t collected_max = 10'000;

/// The same rule, as the config room and the proxy room know it.
[[nodiscard]] proxy::rule rule_of(const config::rule& x);

} // namespace rubicon
