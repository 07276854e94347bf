// A mote: its communication layer, its radio client, its transducers, and the apps that run on it.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "actors/messages.hpp"
#include "actors/timer.hpp"
#include "config/ecology.hpp"
#include "mote/node.hpp"

namespace rubicon {

/// What a mote actor is made of.
struct mote_arguments {
  mote_address address;
  std::string name; ///< `kitchen/climate-7`
  mote::node_config node;
  std::vector<config::mote_app> apps;
  std::uint32_t incarnation = 0; ///< how often it was started before
  std::uint64_t seed = 0;        ///< of the ecology
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

  mote_arguments arguments;
  mote::node node;
  timer wake;
  std::vector<mote_app_actor> apps;
  std::map<std::uint8_t, mote_app_actor> owners; ///< of AM types
  std::map<transport::ticket, waiting_app> waiting;
  transport::ticket next_ticket = 1;
  std::uint64_t unowned = 0; ///< messages of an AM type that no app has claimed
  bool flat = false;
};

/// Spawns the mote's apps and lets it join its island. Apps end with it. An exception in a handler
/// ends the mote; its supervisor starts it again (ACT-03).
mote_actor::behavior_type mote_behavior(scheduler::traced_pointer<mote_state, mote_actor> self,
                                        mote_arguments arguments);

} // namespace rubicon
