#include "communication/program_port.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace rubicon::communication {

program_port::~program_port() = default;

void program_port::numbering::add(std::uint16_t program, int layer) {
  here[program] = layer;
  there[layer] = program;
}

void program_port::numbering::erase(std::uint16_t program) {
  const auto found = here.extract(program);
  if (!found.empty())
    there.erase(found.mapped());
}

std::optional<int> program_port::numbering::find(std::uint16_t program) const {
  const auto found = here.find(program);
  return found == here.end() ? std::nullopt : std::optional(found->second);
}

std::optional<std::uint16_t> program_port::numbering::program(int layer) const {
  const auto found = there.find(layer);
  return found == there.end() ? std::nullopt : std::optional(found->second);
}

remote::limits program_port::limits_of(const layer& x) {
  const auto& streams = x.ports().streams.core().config();
  const auto& synaptic = x.ports().synaptic.core().config();
  const auto& messages = x.ports().messages.core().config();
  remote::limits limits;
  limits.transducer_mask = x.ports().node.config.transducer_mask;
  limits.streams_max = static_cast<std::uint32_t>(streams.streams_max);
  limits.record_max = static_cast<std::uint32_t>(streams.record_max);
  limits.channels_max = static_cast<std::uint32_t>(synaptic.channels_max);
  limits.vector_max = synaptic.size_max;
  limits.sends_max = static_cast<std::uint32_t>(messages.outstanding_max);
  limits.payload_max = static_cast<std::uint32_t>(messages.payload_max);
  return limits;
}

void program_port::catch_up(const layer& x) {
  if (x.ports().node.initialised)
    send_event(remote::initialised{true});
  if (const auto self = layer_.address())
    send_event(remote::joined{*self, true});
}

void program_port::on_commands(const remote::commands_batch& x) {
  events_acked_ = std::min(x.taken, events_sent_);
  commands_ += x.all.size();
  for (const auto& each : x.all) {
    if (!has_left_)
      std::visit([this](const auto& y) { carry_out(y); }, each);
  }
  throttle();
}

/// Once: its place in the layer may be another's afterwards.
void program_port::leave() {
  if (std::exchange(has_left_, true))
    return;
  layer_.leave();
  types_.clear();
  ends_.clear();
}

std::optional<remote::events_batch> program_port::take_events() {
  std::erase_if(ends_, [this](std::uint16_t stream) {
    const auto here = streams_.find(stream);
    const bool has_ended = here && layer_.has_ended(*here);
    if (has_ended)
      send_event(remote::stream_ended{stream});
    return has_ended || !here;
  });
  if (events_.empty() && commands_acked_ == commands_)
    return std::nullopt;
  commands_acked_ = commands_;
  return remote::events_batch{commands_, std::exchange(events_, {})};
}

void program_port::send_event(remote::event x) {
  ++events_sent_;
  events_.push_back(std::move(x));
  throttle();
}

void program_port::send_event_if_room(remote::event x) {
  if (in_flight() < events_max_)
    send_event(std::move(x));
  else
    ++counters_.dropped;
}

/// Senders wait for a program that has many events to take.
void program_port::throttle() {
  const bool is_busy = in_flight() >= events_max_ / 2;
  if (is_busy == is_throttled_)
    return;
  is_throttled_ = is_busy;
  for (const auto am_type : types_) {
    if (is_busy)
      layer_.hold(am_type);
    else if (!held_.contains(am_type))
      layer_.release(am_type);
  }
}

// Synaptic channels.

void program_port::carry_out(const remote::create_channel& x) {
  const auto here = x.is_out ? layer_.create_syn_channel_out(x.other, x.size, x.parameters)
                             : layer_.create_syn_channel_in(x.other, x.size, x.parameters);
  if (here < 0) {
    ++counters_.refused;
    send_event(remote::channel_created{x.channel, x.is_out, false});
    return;
  }
  channels_.add(x.channel, here);
  sizes_[x.channel] = x.size;
}

void program_port::carry_out(const remote::start_channel& x) {
  const auto here = channels_.find(x.channel);
  if (!here || layer_.start_syn_channel(*here) == FAIL)
    ++counters_.refused;
}

void program_port::carry_out(const remote::stop_channel& x) {
  const auto here = channels_.find(x.channel);
  if (!here || layer_.stop_syn_channel(*here) == FAIL)
    ++counters_.refused;
}

void program_port::carry_out(const remote::dispose_channel& x) {
  const auto here = channels_.find(x.channel);
  if (!here || layer_.dispose_syn_channel(*here) == FAIL)
    ++counters_.refused;
  channels_.erase(x.channel);
  sizes_.erase(x.channel);
}

void program_port::carry_out(const remote::set_outputs& x) {
  const auto here = channels_.find(x.channel);
  bool accepted = here.has_value();
  for (std::size_t k = 0; accepted && k < x.values.size(); ++k)
    accepted = layer_.write_output(*here, static_cast<std::uint8_t>(k), x.values[k]) == SUCCESS;
  if (!accepted)
    ++counters_.refused;
}

void program_port::on_created(int channel, bool is_out, status success) {
  const auto id = channels_.program(channel);
  if (!id)
    return;
  send_event(remote::channel_created{*id, is_out, success == SUCCESS});
  if (success == SUCCESS)
    return;
  channels_.erase(*id);
  sizes_.erase(*id);
}

void program_port::createSynChannelOutDone(int channel, status success) {
  on_created(channel, true, success);
}

void program_port::createSynChannelInDone(int channel, status success) {
  on_created(channel, false, success);
}

/// The layer reports all elements of a vector one after the other.
void program_port::syn_input_update(int channel, std::uint8_t index, synaptic::input_status how) {
  const auto id = channels_.program(channel);
  if (!id || index > 0)
    return;
  std::vector<float> values(sizes_.at(*id));
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = layer_.read_input(channel, static_cast<std::uint8_t>(i));
  send_event_if_room(
      remote::inputs_shown{*id, how == synaptic::input_status::updated, std::move(values)});
}

void program_port::carry_out(const remote::want_ticks&) {
  wants_ticks_ = true;
}

void program_port::clock_tick(std::uint32_t tick) {
  send_event_if_room(remote::ticked{tick});
}

void program_port::synChannelFailed(int channel) {
  if (const auto id = channels_.program(channel))
    send_event(remote::channel_failed{*id});
}

// Streams.

void program_port::keep_open(std::uint16_t stream, int here) {
  if (here > 0)
    streams_.add(stream, here);
  else
    ++counters_.refused; // reads and writes will fail
}

void program_port::carry_out(const remote::open_end& x) {
  const auto here = layer_.open_end(x.end);
  keep_open(x.stream, here);
  if (here < 0)
    send_event(remote::stream_opened{x.stream, x.end.name, false, {}});
  else
    ends_.insert(x.stream);
}

void program_port::carry_out(const remote::open_sensor& x) {
  const auto kind = x.is_periodic ? stream::sampling::periodic : stream::sampling::on_demand;
  keep_open(x.stream, layer_.open_sensor(x.transducer, x.period_ms, kind));
}

void program_port::carry_out(const remote::open_local& x) {
  keep_open(x.stream, layer_.open_local());
}

void program_port::carry_out(const remote::close_stream& x) {
  const auto here = streams_.find(x.stream);
  if (!here || layer_.close(*here) == FAIL)
    ++counters_.refused;
  streams_.erase(x.stream);
}

void program_port::carry_out(const remote::read_stream& x) {
  const auto here = streams_.find(x.stream);
  if (here && layer_.read(*here, static_cast<std::size_t>(x.octets)) == SUCCESS)
    return;
  ++counters_.refused;
  send_event(remote::record_read{x.stream, {}, false});
}

void program_port::carry_out(const remote::write_stream& x) {
  const auto here = streams_.find(x.stream);
  if (here && layer_.write(*here, x.record.view()) >= 0)
    return;
  ++counters_.refused;
  send_event(remote::record_read{x.stream, {}, false});
}

void program_port::openRemoteDone(int stream, std::uint16_t name, status success) {
  const auto id = streams_.program(stream);
  if (!id)
    return;
  send_event(remote::stream_opened{*id, name, success == SUCCESS,
                                   layer_.latency_bound(stream).value_or(duration{})});
  if (success == FAIL)
    streams_.erase(*id);
}

void program_port::readDone(int stream, byte_view record, status success) {
  if (const auto id = streams_.program(stream))
    send_event(remote::record_read{*id, payload(to_bytes(record)), success == SUCCESS});
}

// Messages.

void program_port::carry_out(const remote::send_message& x) {
  const auto number = layer_.send_numbered(x.to, x.octets.view(), x.reliable, x.am_type);
  if (!number) {
    ++counters_.refused;
    if (x.reliable)
      send_event(remote::send_ended{x.number, false});
  } else if (x.reliable) {
    sends_[*number] = x.number;
  }
}

void program_port::carry_out(const remote::provide_type& x) {
  if (layer_.provide(x.am_type) == FAIL) {
    ++counters_.refused;
    send_event(remote::type_refused{x.am_type});
    return;
  }
  types_.insert(x.am_type);
  if (is_throttled_)
    layer_.hold(x.am_type);
}

void program_port::carry_out(const remote::hold_type& x) {
  if (x.holds) {
    held_.insert(x.am_type);
    layer_.hold(x.am_type);
    return;
  }
  held_.erase(x.am_type);
  if (!is_throttled_)
    layer_.release(x.am_type);
}

void program_port::ackOf(std::uint32_t number, status success) {
  const auto id = sends_.extract(number);
  if (!id.empty())
    send_event(remote::send_ended{id.mapped(), success == SUCCESS});
}

void program_port::receiveFrom(mote_address source, byte_view octets, std::uint8_t am_type) {
  send_event_if_room(remote::message_received{source, am_type, payload(to_bytes(octets))});
}

// What the mote carries.

void program_port::carry_out(const remote::read_transducers& x) {
  if (layer_.read_transducers(x.kinds) == SUCCESS)
    return;
  ++counters_.refused;
  send_event(remote::transducers_read{});
}

void program_port::carry_out(const remote::set_actuator& x) {
  if (layer_.set_actuator(x.name, x.state) == SUCCESS)
    return;
  ++counters_.refused;
  send_event(remote::actuator_changed{x.name, 0, false});
}

void program_port::transducersRead(std::span<const std::int16_t> counts, std::uint32_t time_ms) {
  send_event(remote::transducers_read{{counts.begin(), counts.end()}, time_ms});
}

void program_port::actuatorChanged(std::string_view name, std::uint8_t state, bool obeyed) {
  send_event(remote::actuator_changed{std::string(name), state, obeyed});
}

// Membership.

void program_port::carry_out(const remote::init&) {
  layer_.initCommunications();
}

void program_port::carry_out(const remote::join& x) {
  if (layer_.joinIsland(x.description.view()) == SUCCESS)
    return;
  ++counters_.refused;
  send_event(remote::joined{});
}

void program_port::carry_out(const remote::leave&) {
  leave();
}

void program_port::initCommunicationsDone(status success) {
  send_event(remote::initialised{success == SUCCESS});
}

/// The address may have an island beyond one octet.
void program_port::joined(island_octet island, std::uint16_t mote, status success) {
  const mote_address given{island_id(island), mote_id(mote)};
  send_event(remote::joined{layer_.address().value_or(given), success == SUCCESS});
}

void program_port::moteJoined(std::uint16_t mote, byte_view description) {
  send_event(remote::mote_joined{mote_id(mote), payload(to_bytes(description))});
}

void program_port::outputsWanted(std::span<const output_wanted> all) {
  send_event(remote::outputs_asked{{all.begin(), all.end()}});
}

} // namespace rubicon::communication
