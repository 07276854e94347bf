// The programs that run on motes. Each is an actor that uses its mote through messages alone, as a
// nesC component would use interfaces: commands out, events in.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "actors/messages.hpp"
#include "actors/mote.hpp"
#include "actors/timer.hpp"
#include "config/ecology.hpp"
#include "core/random.hpp"
#include "core/running_mean.hpp"

namespace rubicon {

struct sampler_state {
  config::sampler_app config;
  mote_actor mote;
  random_stream dice;
  bool in_island = false;
  std::vector<running_mean> means;           ///< of each transducer; empty: counts go as they are
  std::optional<mote::output_wanted> wanted; ///< of its channel, by the gateway
  std::optional<duration> every;             ///< nothing: it rests
  instant next_period;
  std::uint64_t sent = 0;
  std::uint64_t unsent = 0; ///< refused by the mote, or never acknowledged
  timer period;
};

/// Samples and sends while its mote is in the island and, if so configured, somebody subscribes to
/// its channel; at the period that somebody has asked for (IF-04), or its own. Periods start at a
/// random phase.
mote_app_actor::behavior_type sampler(scheduler::traced_pointer<sampler_state, mote_app_actor> self,
                                      config::sampler_app config, mote_actor mote,
                                      std::uint64_t seed);

struct actuator_app_state {
  config::actuator_app config;
  mote_actor mote;
  std::uint8_t current = 0;
};

/// Obeys the first octet of what it receives, and tells the actuator's state after every change and
/// when its mote has joined.
mote_app_actor::behavior_type
actuator(scheduler::traced_pointer<actuator_app_state, mote_app_actor> self,
         config::actuator_app config, mote_actor mote, std::uint8_t initial);

struct messenger_state {
  config::messenger_app config;
  mote_actor mote;
  instant next_message;
  std::uint64_t number = 0;
  timer period;
};

mote_app_actor::behavior_type
messenger(scheduler::traced_pointer<messenger_state, mote_app_actor> self,
          config::messenger_app config, mote_actor mote);

struct listener_state {
  config::listener_app config;
  mote_actor mote;
  ecology_actor ecology;
  std::uint64_t received = 0;
};

/// Tells the story of the first message it receives.
mote_app_actor::behavior_type
listener(scheduler::traced_pointer<listener_state, mote_app_actor> self,
         config::listener_app config, mote_actor mote, ecology_actor ecology);

/// Spawns the apps of a mote, linked to it: a mote and its apps end together.
[[nodiscard]] std::vector<mote_app_actor>
spawn_mote_apps(scheduler::traced_pointer<mote_state, mote_actor> mote);

} // namespace rubicon
