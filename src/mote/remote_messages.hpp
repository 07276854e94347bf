// What a program in an actor of its own and its node's actor tell each other. The program numbers
// its streams, synaptic channels and sends itself; both sides speak of them by its numbers.
#pragma once

#include <cstdint>
#include <variant>
#include <vector>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "mote/outputs_wanted.hpp"
#include "mote/process.hpp"
#include "stream/events.hpp"
#include "synaptic/events.hpp"
#include "synaptic/parameters.hpp"

namespace rubicon::mote::remote {

/// What a program may use of its node: the sizes of the node's tables. Others use them too.
struct limits {
  std::uint32_t transducer_mask = 0;
  std::uint32_t streams_max = 0;
  std::uint32_t record_max = 0;   ///< octets
  std::uint32_t channels_max = 0; ///< synaptic, each way
  std::uint8_t vector_max = 0;    ///< elements of a synaptic channel
  std::uint32_t sends_max = 0;    ///< reliable ones that have not ended
  std::uint32_t payload_max = 0;  ///< octets of a message

  friend bool operator==(const limits&, const limits&) = default;
};

// Commands.

struct create_channel {
  std::uint16_t channel = 0;
  bool is_out = false;
  mote_address other;
  std::uint8_t size = 0;
  synaptic::parameters parameters;
};

struct start_channel {
  std::uint16_t channel = 0;
};

struct stop_channel {
  std::uint16_t channel = 0;
};

struct dispose_channel {
  std::uint16_t channel = 0;
};

/// All of ChOut.
struct set_outputs {
  std::uint16_t channel = 0;
  std::vector<float> values;
};

struct open_end {
  std::uint16_t stream = 0;
  stream_end end;
};

struct open_sensor {
  std::uint16_t stream = 0;
  std::uint8_t transducer = 0;
  bool is_periodic = true;     ///< else on demand
  std::uint32_t period_ms = 0; ///< without meaning on demand
};

struct open_local {
  std::uint16_t stream = 0;
};

struct close_stream {
  std::uint16_t stream = 0;
};

struct read_stream {
  std::uint16_t stream = 0;
  std::uint64_t octets = 0;
};

struct write_stream {
  std::uint16_t stream = 0;
  payload record;
};

struct send_message {
  std::uint32_t number = 0;
  mote_address to;
  payload octets;
  bool reliable = false;
  std::uint8_t am_type = 0;
};

struct provide_type {
  std::uint8_t am_type = 0;
};

/// The program has no room for messages of its type, or has it again.
struct hold_type {
  std::uint8_t am_type = 0;
  bool holds = false;
};

/// The program wants to hear of each tick.
struct want_ticks {};

struct init {};

struct join {
  payload description;
};

/// The program is over.
struct leave {};

using command =
    std::variant<create_channel, start_channel, stop_channel, dispose_channel, set_outputs,
                 open_end, open_sensor, open_local, close_stream, read_stream, write_stream,
                 send_message, provide_type, hold_type, want_ticks, init, join, leave>;
using commands = std::vector<command>;

// Events.

struct channel_created {
  std::uint16_t channel = 0;
  bool is_out = false;
  bool success = false;
};

/// ChIn is this now: syn_input_update for each index.
struct inputs_shown {
  std::uint16_t channel = 0;
  bool updated = false; ///< else missed
  std::vector<float> values;
};

struct channel_failed {
  std::uint16_t channel = 0;
};

struct ticked {
  std::uint32_t tick = 0;
};

struct stream_opened {
  std::uint16_t stream = 0;
  std::uint16_t name = 0;
  bool success = false;
  duration latency_bound{};
};

/// Without success the stream has ended, or could not be written.
struct record_read {
  std::uint16_t stream = 0;
  payload record;
  bool success = false;
};

/// The other end of a remote stream is gone, and nothing is left to be read. No event says so;
/// the next read or write fails.
struct stream_ended {
  std::uint16_t stream = 0;
};

/// Of a reliable send.
struct send_ended {
  std::uint32_t number = 0;
  bool acked = false;
};

struct message_received {
  mote_address source;
  std::uint8_t am_type = 0;
  payload octets;
};

/// Another program had that type first.
struct type_refused {
  std::uint8_t am_type = 0;
};

struct initialised {
  bool success = false;
};

/// The node has joined, or has lost its island; or it cannot begin to join.
struct joined {
  mote_address self;
  bool success = false;
};

struct mote_joined {
  mote_id mote;
  payload description;
};

struct outputs_asked {
  std::vector<output_wanted> all;
};

using event = std::variant<channel_created, inputs_shown, channel_failed, ticked, stream_opened,
                           record_read, stream_ended, send_ended, message_received, type_refused,
                           initialised, joined, mote_joined, outputs_asked>;
using events = std::vector<event>;

/// What goes from the program to its node at once, or back, in order. `taken` is how many events,
/// or commands, of the other side have come so far: how many are under way is bounded (MCK-18).
struct commands_batch {
  std::uint64_t taken = 0;
  commands all;
};

struct events_batch {
  std::uint64_t taken = 0;
  events all;
};

} // namespace rubicon::mote::remote
