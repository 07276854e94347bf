// Motes, sinks, and programs that are not in the actor of their node.
#pragma once

#include <cstdint>
#include <memory>

#include "actors/messages/air.hpp"
#include "actors/messages/backbone.hpp"
#include "actors/messages/common.hpp"
#include "actors/messages/serial.hpp"
#include "communication/remote_messages.hpp"
#include "core/address.hpp"
#include "core/describe/changes.hpp"

namespace rubicon::smepp {
struct key_pair;
} // namespace rubicon::smepp

namespace rubicon {

/// The app has carried its mote somewhere; its waypoints, if it has any, count no more.
struct move_mote {
  position place;
};
RUBICON_FIELDS(move_mote, place);

// Programs that use the Mockup interface and are not in their node's actor.

/// The node has this program now. What it offers; and how often it was started before.
struct program_attached {
  communication::remote::limits limits;
  std::uint32_t incarnation = 0;
};
RUBICON_FIELDS(program_attached, limits, incarnation);

/// The node has stopped for good, and all that is on it.
struct program_detached {};
RUBICON_FIELDS(program_detached);

/// Events, and how far the node is with the program's commands.
struct program_events {
  communication::remote::events_batch batch;
};
RUBICON_FIELDS(program_events, batch);

/// A program, as its node sees it.
struct program_client_interface : takes<program_attached, program_detached, program_events> {};
using program_client_actor = ref<program_client_interface>;

/// A program begins on this node; what it had there before is closed. program_attached follows, if
/// the node still runs.
struct attach_program {
  std::uint32_t number = 0; ///< among the node's programs
  program_client_actor program;
};
RUBICON_FIELDS(attach_program, number, program);

/// Commands, and how far the program is with the node's events.
struct program_commands {
  std::uint32_t number = 0;
  communication::remote::commands_batch batch;
};
RUBICON_FIELDS(program_commands, number, batch);

/// A mote or PC, as such a program sees it.
struct program_node_interface : takes<attach_program, program_commands> {};
using program_node_actor = ref<program_node_interface>;

/// From the fault plan: the next handler throws.
struct crash_now {};
RUBICON_FIELDS(crash_now);

/// From the fault plan: the battery is flat.
struct end_battery {};
RUBICON_FIELDS(end_battery);

/// From the plan: a program of the mote has other settings from now on.
struct change_program {
  bool messenger = false;   ///< a messenger; else a sampler
  std::uint16_t number = 0; ///< its AM type, or its channel
  keys::key_changes settings;
};
RUBICON_FIELDS(change_program, messenger, number, settings);

/// From the plan: other network keys of SMEPP Light. The keys are no field: no trace, record or log
/// has them.
struct set_network_keys {
  std::shared_ptr<const smepp::key_pair> keys; ///< never nullptr
};
RUBICON_FIELDS(set_network_keys);

/// From whoever steers the run: a program of the mote sends this (D1.1 5.3.3).
struct send_as_program {
  std::uint32_t number = 0; ///< in events of its outcome
  mote_address to;
  payload octets;
  bool reliable = true;
  std::uint8_t am_type = 0;
};
RUBICON_FIELDS(send_as_program, number, to, octets, reliable, am_type);

struct mote_interface
    : extends<radio_user_interface, attach_program, program_commands, move_mote, crash_now,
              end_battery, step_clock, change_program, set_network_keys, send_as_program,
              backbone_received, backbone_sent, timer_expired, status_request> {};
using mote_actor = ref<mote_interface>;

/// From whoever spawned both: the program's mote runs, for the first time or again.
struct mote_started {
  mote_actor mote;
};
RUBICON_FIELDS(mote_started, mote);

/// A program in an actor of its own.
struct program_interface
    : extends<program_client_interface, mote_started, timer_expired, status_request> {};
using program_actor = ref<program_interface>;

struct sink_interface : extends<radio_user_interface, serial_octets, crash_now, step_clock,
                                backbone_received, backbone_sent, timer_expired, status_request> {};
using sink_actor = ref<sink_interface>;

} // namespace rubicon
