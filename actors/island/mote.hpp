// A mote: its communication layer, its radio client, its transducers, and the programs that run on
// it.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "actors/base/timer.hpp"
#include "actors/hosts/firmware_shell.hpp"
#include "actors/hosts/flow_host.hpp"
#include "actors/hosts/plain_host.hpp"
#include "actors/island/program_host.hpp"
#include "actors/island/separate_programs.hpp"
#include "actors/island/smepp_shell.hpp"
#include "actors/messages/air.hpp"
#include "actors/messages/backbone.hpp"
#include "actors/messages/programs.hpp"
#include "actors/messages/supervision.hpp"
#include "apps/messenger.hpp"
#include "apps/sampler.hpp"
#include "config/plan/ecology.hpp"
#include "core/shared_list.hpp"
#include "core/small_map.hpp"
#include "device/walk.hpp"
#include "mote/crystal.hpp"
#include "mote/node.hpp"
#include "mote/nonvolatile.hpp"

namespace rubicon {

/// From when a mote sees that its battery ends, as the fault plan has it, to its end.
inline constexpr duration last_words_time = 1s;

/// What a mote actor is made of, the same in all its lives.
struct mote_arguments {
  mote_address address;
  std::string name; ///< `kitchen/climate-7`
  config::stack stack = config::stack::full;
  mote::node_config node;                               ///< full stack only
  std::shared_ptr<const smepp::node_config> smepp;      ///< nullptr without an app `member`
  std::shared_ptr<smepp::persistent_state> smepp_state; ///< with it: what its lives have stored
  mote::crystal crystal;
  shared_list<config::mote_app> apps;
  std::vector<device::waypoint> path; ///< empty: it does not move
  duration step = 1s;                 ///< of its moves
  bool stays_when_flat = false;       ///< its walk ends with its battery
  std::uint64_t seed = 0;             ///< of the ecology
  radio::radio_index radio;
  std::uint8_t channel = radio::default_channel; ///< of its radio
  air_actor air;
  backbone_actor backbone; ///< of a further sink; empty: it is none
  ecology_actor ecology;
};

struct mote_state {
  static constexpr std::uint8_t walk_timer = 2;
  static constexpr std::uint8_t last_words_timer = 3;
  static constexpr std::uint8_t reports_timer = 4;
  static constexpr std::uint8_t groups_timer = 5;

  std::shared_ptr<const mote_arguments> arguments;
  mote::crystal crystal;          ///< as the clock of this life shows it
  mote::nonvolatile store;        ///< as it was before this life
  std::optional<mote::node> node; ///< full stack only
  flow_host flows;
  std::unique_ptr<plain_host> plain;        ///< nullptr: no plain programs of TinyOS
  std::unique_ptr<firmware_shell> firmware; ///< nullptr: none
  std::unique_ptr<smepp_shell> groups;      ///< nullptr: none, as in most motes; it is large
  radio_demand radio;
  /// How it moves.
  struct moving {
    device::walk walk;
    timer wake{walk_timer};
  };
  std::unique_ptr<moving> moves; ///< nullptr: not at all
  timer wake;
  instant due = instant::min();       ///< by the mote's clock, what `wake` follows,
  instant due_real;                   ///< and by the world's: several conversions find it
  timer last_words{last_words_timer}; ///< until the fault plan's end of the battery
  timer reports_wake{reports_timer};
  timer groups_wake{groups_timer};
  /// Samplers, actuators, messengers and listeners. They go by the world's time: what they are
  /// asked for, and judged by, are periods of those who listen to them.
  program_host reports;
  small_map<std::uint16_t, apps::sampler*> samplers;     ///< among them, by channel
  small_map<std::uint16_t, apps::messenger*> messengers; ///< the same, by AM type
  program_host programs;                                 ///< all others, in the mote's own time
  separate_programs separate;
  std::uint32_t program_turns = 0;     ///< of the node, when programs were last asked,
  std::optional<instant> programs_due; ///< and what those in the mote's time said
  std::optional<instant> rests_since;  ///< no search has found a neighbour that knows the time
  bool flat = false;
};

/// With the full stack, starts the mote's programs and lets it join its island. An
/// exception in a handler ends the mote; its supervisor starts it again (ACT-03).
/// @param arguments not nullptr
/// @param store as earlier lives have written it
mote_actor::behavior_type mote_behavior(scheduler::actor_pointer<mote_state, mote_actor> self,
                                        std::shared_ptr<const mote_arguments> arguments,
                                        mote::nonvolatile store);

} // namespace rubicon
