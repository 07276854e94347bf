// The keys of what a file may say about programs.
#pragma once

#include <cstdint>

#include "apps/app_config.hpp"
#include "core/describe/keys.hpp"

namespace rubicon::apps {

inline constexpr keys::time_span report_period{10ms, 24h * 10}; ///< of samplers and messengers
inline constexpr keys::time_span record_period{10ms, 24h};      ///< of streams
inline constexpr std::uint8_t vector_max = 64;

inline auto keys_of(const sampler_config*) {
  return keys::of(
      keys::optional("every", &sampler_config::every, report_period, "from one message to the next")
          .changeable("begins at a random phase"),
      keys::optional(
          "jitter", &sampler_config::jitter, keys::time_span{0s, 24h * 10},
          {"each period starts up to this much late, at random", "", "time up to `every`"}),
      keys::optional("channel", &sampler_config::channel, keys::whole<std::uint16_t>{0, 255},
                     "output channel, `devices.ID.output.CHANNEL` at the gateway"),
      keys::optional("reliable", &sampler_config::reliable, keys::flag{},
                     "ask for an end-to-end acknowledgement")
          .changeable(),
      keys::optional("only_subscribed", &sampler_config::only_subscribed, keys::flag{},
                     "it sends only while a PEIS component subscribes to its output tuple, by its "
                     "key or a pattern that begins with `devices`")
          .changeable(),
      keys::optional("stamped", &sampler_config::stamped, keys::flag{},
                     "append the time of sampling to the counts (D1.1 2.1): 4 octets, big-endian, "
                     "the low 32 bits of the [network time](gateway.md#time) in milliseconds; a "
                     "[field](#proxyfield) with `encoding = \"stamp\"` has the whole time"));
}

inline auto keys_of(const actuator_config*) {
  return keys::of(keys::required("actuator", &actuator_config::actuator, keys::name_text{},
                                 "an actuator of the mote"),
                  keys::optional("channel", &actuator_config::channel,
                                 keys::whole<std::uint16_t>{0, 255},
                                 "input channel, and output channel of the answer"));
}

inline auto keys_of(const messenger_config*) {
  return keys::of(
      keys::required("to", &messenger_config::to, keys::mote_name{}, "receiver"),
      keys::required("text", &messenger_config::text, keys::text{}, "text of the message")
          .changeable(),
      keys::optional("every", &messenger_config::every, report_period,
                     "from one message to the next")
          .changeable("the next message is sent one period later"),
      keys::optional("am_type", &messenger_config::am_type, keys::whole<std::uint8_t>{},
                     "channel of the listener"),
      keys::optional("reliable", &messenger_config::reliable, keys::flag{},
                     "ask for an end-to-end acknowledgement")
          .changeable(),
      keys::optional("count", &messenger_config::count, keys::whole<std::uint32_t>{1},
                     {"number of messages that it sends, again so many after a restart of its mote",
                      "no limit"}));
}

inline auto keys_of(const listener_config*) {
  return keys::of(keys::optional("am_type", &listener_config::am_type, keys::whole<std::uint8_t>{},
                                 "AM type of the messages that it counts"));
}

inline auto keys_of(const stream_writer_config*) {
  return keys::of(
      keys::required("transducer", &stream_writer_config::transducer, keys::quantity_name{},
                     {"a transducer of the mote", "", "quantity"}),
      keys::required("to", &stream_writer_config::to, keys::node_name{}, "node of the read end"),
      keys::optional("every", &stream_writer_config::every, record_period,
                     "from one record to the next"),
      keys::optional("stream", &stream_writer_config::stream, keys::whole<std::uint16_t>{},
                     "symbolic name, the same at both ends"));
}

inline auto keys_of(const stream_reader_config*) {
  return keys::of(
      keys::optional("every", &stream_reader_config::every, record_period, "as the writer's"),
      keys::optional("stream", &stream_reader_config::stream, keys::whole<std::uint16_t>{},
                     "symbolic name"));
}

inline auto keys_of(const synapse*) {
  return keys::of(
      keys::required("node", &synapse::other, keys::node_name{}, "the other end"),
      keys::optional("size", &synapse::size, keys::whole<std::uint8_t>{1, vector_max}, "elements"));
}

inline auto keys_of(const reservoir_config*) {
  return keys::of(keys::optional("units", &reservoir_config::units,
                                 keys::whole<std::uint8_t>{1, vector_max}, "number of units"),
                  keys::optional("leak", &reservoir_config::leak, keys::ratio{},
                                 "share of the new input in a unit's next state"),
                  keys::optional("radius", &reservoir_config::radius, keys::ratio{},
                                 "bound of the spectral radius of the units' own weights"));
}

inline auto keys_of(const readout_config*) {
  return keys::of(keys::optional("warm_up", &readout_config::warm_up, keys::whole<std::uint32_t>{},
                                 "ticks before errors count"),
                  keys::optional("forgetting", &readout_config::forgetting, keys::real{0.5, 1},
                                 "weight of the past, per tick"));
}

inline auto keys_of(const average_config*) {
  return keys::of(keys::optional("every", &average_config::every, record_period,
                                 "period of the means, and of the writers"));
}

inline auto keys_of(const stream_output*) {
  return keys::of(
      keys::required("to", &stream_output::to, keys::node_name{},
                     "node of the read end; it may be the node of the average itself"),
      keys::optional("stream", &stream_output::stream, keys::whole<std::uint16_t>{},
                     "symbolic name; no other output has it, nor is it among `streams`"));
}

inline auto keys_of(const stream_switch_config*) {
  return keys::of(
      keys::optional("stream", &stream_switch_config::stream, keys::whole<std::uint16_t>{},
                     "symbolic name of the stream that ends here"),
      keys::optional("every", &stream_switch_config::every, record_period, "as the writer's"),
      keys::required("on_at", &stream_switch_config::on_at, keys::real{},
                     "in counts of the stream"),
      keys::required("off_at", &stream_switch_config::off_at, keys::real{},
                     "the same; not equal to `on_at`"),
      keys::required("to", &stream_switch_config::to, keys::mote_name{}, "mote with the actuator"),
      keys::optional("channel", &stream_switch_config::channel, keys::whole<std::uint8_t>{},
                     "channel of its app `actuator`"));
}

inline auto keys_of(const recorder_config*) {
  return keys::of(
      keys::optional("every", &recorder_config::every, record_period, "as the writers'"));
}

} // namespace rubicon::apps
