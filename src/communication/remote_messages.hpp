// The messages between a program in an actor of its own and its node's actor. The program numbers
// its streams, synaptic channels and sends itself; both sides speak of them by its numbers.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "communication/outputs_wanted.hpp"
#include "communication/process.hpp"
#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/describe/fields.hpp"
#include "device/transducer_config.hpp"
#include "stream/events.hpp"
#include "synaptic/events.hpp"
#include "synaptic/parameters.hpp"

namespace rubicon::communication::remote {

/// What a program may use of its node: the sizes of the node's tables. Others use them too.
struct limits {
  std::uint32_t transducer_mask = 0;
  std::uint32_t streams_max = 0;
  std::uint32_t record_max = 0;   ///< octets
  std::uint32_t channels_max = 0; ///< synaptic, in each direction
  std::uint8_t vector_max = 0;    ///< elements of a synaptic channel
  std::uint32_t sends_max = 0;    ///< reliable ones that have not ended
  std::uint32_t payload_max = 0;  ///< octets of a message

  friend bool operator==(const limits&, const limits&) = default;
};
RUBICON_FIELDS(limits, transducer_mask, streams_max, record_max, channels_max, vector_max,
               sends_max, payload_max);

// Commands.

struct create_channel {
  std::uint16_t channel = 0;
  bool is_out = false;
  mote_address other;
  std::uint8_t size = 0;
  synaptic::parameters parameters;
};
RUBICON_FIELDS(create_channel, channel, is_out, other, size, parameters);

struct start_channel {
  std::uint16_t channel = 0;
};
RUBICON_FIELDS(start_channel, channel);

struct stop_channel {
  std::uint16_t channel = 0;
};
RUBICON_FIELDS(stop_channel, channel);

struct dispose_channel {
  std::uint16_t channel = 0;
};
RUBICON_FIELDS(dispose_channel, channel);

/// All of ChOut.
struct set_outputs {
  std::uint16_t channel = 0;
  std::vector<float> values;
};
RUBICON_FIELDS(set_outputs, channel, values);

struct open_end {
  std::uint16_t stream = 0;
  stream_end end;
};
RUBICON_FIELDS(open_end, stream, end);

struct open_sensor {
  std::uint16_t stream = 0;
  std::uint8_t transducer = 0;
  bool is_periodic = true;     ///< else on demand
  std::uint32_t period_ms = 0; ///< without meaning on demand
};
RUBICON_FIELDS(open_sensor, stream, transducer, is_periodic, period_ms);

struct open_local {
  std::uint16_t stream = 0;
};
RUBICON_FIELDS(open_local, stream);

struct close_stream {
  std::uint16_t stream = 0;
};
RUBICON_FIELDS(close_stream, stream);

struct read_stream {
  std::uint16_t stream = 0;
  std::uint64_t octets = 0;
};
RUBICON_FIELDS(read_stream, stream, octets);

struct write_stream {
  std::uint16_t stream = 0;
  payload record;
};
RUBICON_FIELDS(write_stream, stream, record);

struct send_message {
  std::uint32_t number = 0;
  mote_address to;
  payload octets;
  bool reliable = false;
  std::uint8_t am_type = 0;
};
RUBICON_FIELDS(send_message, number, to, octets, reliable, am_type);

struct provide_type {
  std::uint8_t am_type = 0;
};
RUBICON_FIELDS(provide_type, am_type);

/// The program has no room for messages of its type, or has it again.
struct hold_type {
  std::uint8_t am_type = 0;
  bool holds = false;
};
RUBICON_FIELDS(hold_type, am_type, holds);

/// The program wants to be notified of each tick.
struct want_ticks {};
RUBICON_FIELDS(want_ticks);

struct read_transducers {
  std::vector<device::quantity> kinds;
};
RUBICON_FIELDS(read_transducers, kinds);

struct set_actuator {
  std::string name;
  std::uint8_t state = 0;
};
RUBICON_FIELDS(set_actuator, name, state);

struct init {};
RUBICON_FIELDS(init);

struct join {
  payload description;
};
RUBICON_FIELDS(join, description);

/// The program is over.
struct leave {};
RUBICON_FIELDS(leave);

using command = std::variant<create_channel, start_channel, stop_channel, dispose_channel,
                             set_outputs, open_end, open_sensor, open_local, close_stream,
                             read_stream, write_stream, send_message, provide_type, hold_type,
                             want_ticks, read_transducers, set_actuator, init, join, leave>;
using commands = std::vector<command>;

// Events.

struct channel_created {
  std::uint16_t channel = 0;
  bool is_out = false;
  bool success = false;
};
RUBICON_FIELDS(channel_created, channel, is_out, success);

/// ChIn is this now: syn_input_update for each index.
struct inputs_shown {
  std::uint16_t channel = 0;
  bool updated = false; ///< else missed
  std::vector<float> values;
};
RUBICON_FIELDS(inputs_shown, channel, updated, values);

struct channel_failed {
  std::uint16_t channel = 0;
};
RUBICON_FIELDS(channel_failed, channel);

struct ticked {
  std::uint32_t tick = 0;
};
RUBICON_FIELDS(ticked, tick);

struct stream_opened {
  std::uint16_t stream = 0;
  std::uint16_t name = 0;
  bool success = false;
  duration latency_bound{};
};
RUBICON_FIELDS(stream_opened, stream, name, success, latency_bound);

/// Without success the stream has ended, or could not be written.
struct record_read {
  std::uint16_t stream = 0;
  payload record;
  bool success = false;
};
RUBICON_FIELDS(record_read, stream, record, success);

/// The other end of a remote stream is gone, and nothing is left to be read. No event says so;
/// the next read or write fails.
struct stream_ended {
  std::uint16_t stream = 0;
};
RUBICON_FIELDS(stream_ended, stream);

/// Of a reliable send.
struct send_ended {
  std::uint32_t number = 0;
  bool acked = false;
};
RUBICON_FIELDS(send_ended, number, acked);

struct message_received {
  mote_address source;
  std::uint8_t am_type = 0;
  payload octets;
};
RUBICON_FIELDS(message_received, source, am_type, octets);

/// Another program had that type first.
struct type_refused {
  std::uint8_t am_type = 0;
};
RUBICON_FIELDS(type_refused, am_type);

struct transducers_read {
  std::vector<std::int16_t> counts; ///< none: the node has not all that were asked for
  std::uint32_t time_ms = 0;
};
RUBICON_FIELDS(transducers_read, counts, time_ms);

struct actuator_changed {
  std::string name;
  std::uint8_t state = 0;
  bool obeyed = false;
};
RUBICON_FIELDS(actuator_changed, name, state, obeyed);

struct initialised {
  bool success = false;
};
RUBICON_FIELDS(initialised, success);

/// The node has joined, or has lost its island; or it cannot begin to join.
struct joined {
  mote_address self;
  bool success = false;
};
RUBICON_FIELDS(joined, self, success);

struct mote_joined {
  mote_id mote;
  payload description;
};
RUBICON_FIELDS(mote_joined, mote, description);

struct outputs_asked {
  std::vector<output_wanted> all;
};
RUBICON_FIELDS(outputs_asked, all);

using event =
    std::variant<channel_created, inputs_shown, channel_failed, ticked, stream_opened, record_read,
                 stream_ended, send_ended, message_received, type_refused, transducers_read,
                 actuator_changed, initialised, joined, mote_joined, outputs_asked>;
using events = std::vector<event>;

/// What goes from the program to its node at once, or back, in order. `taken` is how many events,
/// or commands, of the other side have come so far: how many are in flight is bounded (MCK-18).
struct commands_batch {
  std::uint64_t taken = 0;
  commands all;
};
RUBICON_FIELDS(commands_batch, taken, all);

struct events_batch {
  std::uint64_t taken = 0;
  events all;
};
RUBICON_FIELDS(events_batch, taken, all);

} // namespace rubicon::communication::remote
