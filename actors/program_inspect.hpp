// CAF's inspect for what programs in actors of their own and their motes tell each other.
#pragma once

#include <cstdint>
#include <type_traits>
#include <utility>
#include <variant>

#include <caf/deserializer.hpp>
#include <caf/meta/type_name.hpp>
#include <caf/sec.hpp>
#include <caf/serializer.hpp>

#include "actors/inspect.hpp"
#include "mote/remote_messages.hpp"

namespace rubicon::synaptic {

template <class F>
auto inspect(F& f, parameters& x) {
  return f(caf::meta::type_name("parameters"), x.island, x.divisor, x.qos);
}

} // namespace rubicon::synaptic

namespace rubicon::mote {

template <class F>
auto inspect(F& f, output_wanted& x) {
  return f(caf::meta::type_name("output_wanted"), x.channel, x.period);
}

template <class F>
auto inspect(F& f, stream_end& x) {
  return f(caf::meta::type_name("stream_end"), x.writes_to_self, x.other, x.name, x.rate_ms, x.qos,
           x.buffer_size);
}

namespace remote {

template <class F>
auto inspect(F& f, limits& x) {
  return f(caf::meta::type_name("limits"), x.transducer_mask, x.streams_max, x.record_max,
           x.channels_max, x.vector_max, x.sends_max, x.payload_max);
}

template <class F>
auto inspect(F& f, create_channel& x) {
  return f(caf::meta::type_name("create_channel"), x.channel, x.is_out, x.other, x.size,
           x.parameters);
}

template <class F>
auto inspect(F& f, start_channel& x) {
  return f(caf::meta::type_name("start_channel"), x.channel);
}

template <class F>
auto inspect(F& f, stop_channel& x) {
  return f(caf::meta::type_name("stop_channel"), x.channel);
}

template <class F>
auto inspect(F& f, dispose_channel& x) {
  return f(caf::meta::type_name("dispose_channel"), x.channel);
}

template <class F>
auto inspect(F& f, set_outputs& x) {
  return f(caf::meta::type_name("set_outputs"), x.channel, x.values);
}

template <class F>
auto inspect(F& f, open_end& x) {
  return f(caf::meta::type_name("open_end"), x.stream, x.end);
}

template <class F>
auto inspect(F& f, open_sensor& x) {
  return f(caf::meta::type_name("open_sensor"), x.stream, x.transducer, x.is_periodic, x.period_ms);
}

template <class F>
auto inspect(F& f, open_local& x) {
  return f(caf::meta::type_name("open_local"), x.stream);
}

template <class F>
auto inspect(F& f, close_stream& x) {
  return f(caf::meta::type_name("close_stream"), x.stream);
}

template <class F>
auto inspect(F& f, read_stream& x) {
  return f(caf::meta::type_name("read_stream"), x.stream, x.octets);
}

template <class F>
auto inspect(F& f, write_stream& x) {
  return f(caf::meta::type_name("write_stream"), x.stream, x.record);
}

template <class F>
auto inspect(F& f, send_message& x) {
  return f(caf::meta::type_name("send_message"), x.number, x.to, x.octets, x.reliable, x.am_type);
}

template <class F>
auto inspect(F& f, provide_type& x) {
  return f(caf::meta::type_name("provide_type"), x.am_type);
}

template <class F>
auto inspect(F& f, hold_type& x) {
  return f(caf::meta::type_name("hold_type"), x.am_type, x.holds);
}

template <class F>
auto inspect(F& f, want_ticks&) {
  return f(caf::meta::type_name("want_ticks"));
}

template <class F>
auto inspect(F& f, init&) {
  return f(caf::meta::type_name("init"));
}

template <class F>
auto inspect(F& f, join& x) {
  return f(caf::meta::type_name("join"), x.description);
}

template <class F>
auto inspect(F& f, leave&) {
  return f(caf::meta::type_name("leave"));
}

template <class F>
auto inspect(F& f, channel_created& x) {
  return f(caf::meta::type_name("channel_created"), x.channel, x.is_out, x.success);
}

template <class F>
auto inspect(F& f, inputs_shown& x) {
  return f(caf::meta::type_name("inputs_shown"), x.channel, x.updated, x.values);
}

template <class F>
auto inspect(F& f, channel_failed& x) {
  return f(caf::meta::type_name("channel_failed"), x.channel);
}

template <class F>
auto inspect(F& f, ticked& x) {
  return f(caf::meta::type_name("ticked"), x.tick);
}

template <class F>
auto inspect(F& f, stream_opened& x) {
  return f(caf::meta::type_name("stream_opened"), x.stream, x.name, x.success, x.latency_bound);
}

template <class F>
auto inspect(F& f, record_read& x) {
  return f(caf::meta::type_name("record_read"), x.stream, x.record, x.success);
}

template <class F>
auto inspect(F& f, stream_ended& x) {
  return f(caf::meta::type_name("stream_ended"), x.stream);
}

template <class F>
auto inspect(F& f, send_ended& x) {
  return f(caf::meta::type_name("send_ended"), x.number, x.acked);
}

template <class F>
auto inspect(F& f, message_received& x) {
  return f(caf::meta::type_name("message_received"), x.source, x.am_type, x.octets);
}

template <class F>
auto inspect(F& f, type_refused& x) {
  return f(caf::meta::type_name("type_refused"), x.am_type);
}

template <class F>
auto inspect(F& f, initialised& x) {
  return f(caf::meta::type_name("initialised"), x.success);
}

template <class F>
auto inspect(F& f, joined& x) {
  return f(caf::meta::type_name("joined"), x.self, x.success);
}

template <class F>
auto inspect(F& f, mote_joined& x) {
  return f(caf::meta::type_name("mote_joined"), x.mote, x.description);
}

template <class F>
auto inspect(F& f, outputs_asked& x) {
  return f(caf::meta::type_name("outputs_asked"), x.all);
}

/// The alternative of that index, with default values. @returns false if there is none
template <class... Each>
bool become(std::variant<Each...>& x, std::uint8_t index) {
  std::uint8_t next = 0;
  return ((next++ == index ? (x = Each{}, true) : false) || ...);
}

/// Of commands and events: which alternative, and then the alternative itself.
template <class F, class... Each>
typename F::result_type inspect(F& f, std::variant<Each...>& x) {
  auto index = static_cast<std::uint8_t>(x.index());
  if constexpr (std::is_base_of_v<caf::deserializer, F>) {
    if (auto error = f(index))
      return error;
    if (!become(x, index))
      return caf::sec::unknown_type;
  } else if constexpr (std::is_base_of_v<caf::serializer, F>) {
    if (auto error = f(index))
      return error;
  }
  return std::visit([&f](auto& y) { return f(y); }, x);
}

template <class F>
auto inspect(F& f, commands_batch& x) {
  return f(caf::meta::type_name("commands_batch"), x.taken, x.all);
}

template <class F>
auto inspect(F& f, events_batch& x) {
  return f(caf::meta::type_name("events_batch"), x.taken, x.all);
}

} // namespace remote

} // namespace rubicon::mote
