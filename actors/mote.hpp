// A mote: its communication layer, its radio client, its transducers, and the apps that run on it.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "actors/flow_host.hpp"
#include "actors/messages.hpp"
#include "actors/timer.hpp"
#include "config/ecology.hpp"
#include "mote/node.hpp"
#include "mote/walk.hpp"

namespace rubicon {

/// What a mote actor is made of, the same in all its lives.
struct mote_arguments {
  mote_address address;
  std::string name; ///< `kitchen/climate-7`
  config::stack stack = config::stack::full;
  mote::node_config node; ///< full stack only
  std::vector<config::mote_app> apps;
  std::vector<mote::way_point> path; ///< empty: it does not move
  duration step = 1s;                ///< of its moves
  std::uint64_t seed = 0;            ///< of the ecology
  radio::radio_index radio;
  air_actor air;
  ecology_actor ecology;
};

struct mote_state {
  /// Which app is to hear about a reliable send.
  struct waiting_app {
    mote_app_actor app;
    std::uint64_t token = 0;
  };

  static constexpr std::uint8_t walk_timer = 2;

  std::shared_ptr<const mote_arguments> arguments;
  std::uint32_t incarnation = 0;    ///< how often it was started before
  std::unique_ptr<mote::node> node; ///< full stack only
  flow_host flows;
  mote::walk walk;
  timer wake;
  timer walk_wake{walk_timer};
  std::vector<mote_app_actor> apps;
  std::map<std::uint8_t, mote_app_actor> owners; ///< of AM types
  std::map<transport::ticket, waiting_app> waiting;
  transport::ticket next_ticket = 1;
  std::uint64_t unowned = 0; ///< messages of an AM type that no app has claimed
  bool flat = false;
};

/// Spawns the mote's apps and, with the full stack, lets it join its island. Apps end with it. An
/// exception in a handler ends the mote; its supervisor starts it again (ACT-03).
/// @param arguments not nullptr
/// @param incarnation how often it was started before
mote_actor::behavior_type mote_behavior(scheduler::traced_pointer<mote_state, mote_actor> self,
                                        std::shared_ptr<const mote_arguments> arguments,
                                        std::uint32_t incarnation);

} // namespace rubicon
