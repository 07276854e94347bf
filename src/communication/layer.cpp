#include "communication/layer.hpp"

#include <algorithm>
#include <utility>

#include "core/account/message_ledger.hpp"
#include "core/codec.hpp"
#include "network/am.hpp"

namespace rubicon::communication {

namespace {

/// Handles of tunnels: no channel of Network begins at everybody.
constexpr std::uint32_t tunnel_handles = 0xffff'0000;

stream::channel_handle handle_of(transport::tunnel_id x) {
  return stream::channel_handle(tunnel_handles | (x.value & 0xffff));
}

bool is_tunnel(stream::channel_handle x) {
  return x.value >= tunnel_handles;
}

message_kind kind_of(stream::channel_handle x) {
  return is_tunnel(x) ? message_kind::tunnel : message_kind::channel;
}

transport::tunnel_id tunnel_of(stream::channel_handle x) {
  return transport::tunnel_id(x.value & 0xffff);
}

/// Says where a sensor record comes from, if its island was not known when it was taken.
void set_island(bytes& record, island_id island) {
  const auto octets = byte_writer().big(island.value).finish();
  if (record.size() < octets.size() || byte_reader(record).big<std::uint32_t>() != 0)
    return;
  std::ranges::copy(octets, record.begin());
}

} // namespace

layer::layer() = default;
layer::~layer() = default;

layer::layer(layer_config config, random_stream rng) : config_(config) {
  config.messages.self = config.self;
  config.messages.incarnation = config.incarnation;
  messages_ = transport::messenger(config.messages, rng);
  config.tunnels.self = config.self;
  config.tunnels.slacks = config.messages.slacks;
  config.tunnels.incarnation = config.incarnation;
  tunnels_ = transport::tunnels(config.tunnels);
  config.streams.transducers = transducers_max;
  streams_ = stream::streams(config.streams);
  synaptic_ = synaptic::channels(config.synaptic);
}

interface layer::attach(communication_events& events, std::string name) {
  const auto left =
      std::ranges::find_if(programs_, [](const auto& x) { return x->events_ == nullptr; });
  auto& program =
      left != programs_.end()
          ? **left
          : *programs_.emplace_back(std::make_unique<direct_process>(*this, programs_.size()));
  program.events_ = &events;
  program.name_ = std::move(name);
  if (!outputs_wanted_.empty())
    notify_outputs_wanted(program.number_);
  return interface(program);
}

interface layer::attach_for_rest(communication_events& events) {
  const auto program = attach(events);
  const auto its =
      std::ranges::find_if(programs_, [&](const auto& x) { return x->events_ == &events; });
  rest_owner_ = (*its)->number_;
  return program;
}

layer_outputs layer::take_outputs() {
  dispatch();
  return std::exchange(outputs_, {});
}

/// Delivers events to programs, and what they cause.
void layer::dispatch() {
  if (std::exchange(dispatching_, true))
    return;
  while (!events_.empty()) {
    auto [process, what] = std::move(events_.front());
    events_.erase(events_.begin());
    what(*programs_[process]->events_);
  }
  dispatching_ = false;
}

void layer::notify(std::size_t process, event x) {
  if (programs_[process]->events_ != nullptr)
    events_.emplace_back(process, std::move(x));
}

void layer::note(std::size_t process, program_note x) const {
  x.program = programs_[process]->name_;
  if (observer_ && (!x.program.empty() || x.what == program_note::kind::sent))
    observer_(x);
}

void layer::notify_all(const event& x) {
  for (std::size_t i = 0; i < programs_.size(); ++i)
    notify(i, x);
}

template <class Owners>
void layer::notify_owner(const Owners& owners, typename Owners::key_type of, event x) {
  const auto owner = owners.find(of);
  if (owner != owners.end())
    notify(owner->second, std::move(x));
}

// Membership.

mote_address layer::self() const {
  return {island_.value_or(own_island), config_.self};
}

status layer::refuse() {
  ++counters_.refused;
  return FAIL;
}

bool layer::owns(std::size_t process, std::uint8_t am_type) const {
  const auto owner = owners_.find(am_type);
  return owner != owners_.end() && owner->second == process;
}

bool layer::may_talk() {
  if (island_)
    return true;
  ++counters_.before_join;
  return false;
}

void layer::on_initialised(bool success, instant now) {
  now_ = now;
  initialised_ = success;
  notify_all([success](auto& x) { x.initCommunicationsDone(status_of(success)); });
}

void layer::on_joined(island_id island, instant now) {
  now_ = now;
  island_ = island;
  messages_.join(island);
  tunnels_.join(island);
  const auto at = self();
  notify_all([at](auto& x) { x.joined(octet_of(at.island), at.mote.value, SUCCESS); });
}

void layer::on_left(instant now) {
  now_ = now;
  const auto at = self();
  island_.reset();
  take(messages_.fail_all());
  notify_all([at](auto& x) { x.joined(octet_of(at.island), at.mote.value, FAIL); });
}

void layer::on_mote_joined(mote_id mote, byte_view description, instant now) {
  now_ = now;
  notify_all([mote, octets = to_bytes(description)](auto& x) { x.moteJoined(mote.value, octets); });
}

// Messages.

std::optional<std::uint32_t> layer::send(direct_process& from, mote_address to, byte_view buf,
                                         bool reliable, std::uint8_t am_type) {
  using kind = program_note::kind;
  const bool is_valid = to.island.value > 0 && to.mote != mote_id{};
  ++counters_.offered;
  const acting_on its_copies(begin_message(message_kind::message, self(), to));
  std::optional<transport::outputs> accepted;
  if (!may_talk() || !is_valid)
    ++(island_ ? counters_.misaddressed : counters_.unjoined);
  else
    accepted = messages_.send(++last_number_, to, am_type, to_bytes(buf), reliable, now_);
  const auto number = accepted ? last_number_ : 0;
  note(from.number_, {kind::sent, {}, number, to, am_type, buf, {}, 0, reliable});
  if (!accepted || !reliable)
    note(from.number_, {.what = kind::send_ended, .number = number});
  if (!accepted) {
    refuse_message();
    refuse();
    return std::nullopt;
  }
  if (reliable) {
    senders_[number] = from.number_;
    from.sends_.push_back({number, {}});
  }
  take(*std::move(accepted));
  return number;
}

void layer::take(transport::outputs todo) {
  for (auto& x : todo) {
    if (auto* packet = std::get_if<transport::to_network>(&x))
      outputs_.emplace_back(std::move(*packet));
    else if (auto* message = std::get_if<transport::received>(&x))
      on_received(*message);
    else
      on_outcome(std::get<transport::outcome>(x));
  }
}

void layer::notify_outputs_wanted(std::size_t process) {
  notify(process, [all = outputs_wanted_](auto& x) { x.outputsWanted(all); });
}

void layer::on_outputs_wanted(const transport::received& x) {
  auto all = decode_outputs_wanted(x.payload);
  if (!all) {
    ++counters_.malformed;
    return;
  }
  outputs_wanted_ = *std::move(all);
  for (std::size_t i = 0; i < programs_.size(); ++i)
    notify_outputs_wanted(i);
}

void layer::on_received(transport::received& x) {
  const bool from_gateway = x.source == mote_address{self().island, no_mote};
  if (x.am_type == network::am::outputs_wanted && from_gateway) {
    note_arrival(message_kind::message, x.source);
    on_outputs_wanted(x);
    return;
  }
  const auto known = owners_.find(x.am_type);
  const auto owner = known == owners_.end() ? rest_owner_ : known->second;
  if (!owner) {
    ++counters_.unowned;
    note_loss(loss::no_program);
    return;
  }
  if (known != owners_.end()) // who takes the rest may refuse a message, and notes what it did
    note_arrival(message_kind::message, x.source);
  note(*owner, {program_note::kind::received, {}, 0, x.source, x.am_type, x.payload, {}, 0, false});
  notify(*owner, [message = std::move(x)](auto& events) {
    events.receiveFrom(message.source, message.payload, message.am_type);
  });
}

void layer::on_outcome(const transport::outcome& x) {
  const auto sender = senders_.extract(x.id);
  if (!sender)
    return;
  const auto process = *sender;
  const auto number = static_cast<std::uint32_t>(x.id);
  const auto result = status_of(x.acked);
  note(process, {.what = program_note::kind::send_ended, .number = number, .yes = x.acked});
  notify(process, [number, result](auto& events) { events.ackOf(number, result); });
  auto& sends = programs_[process]->sends_;
  std::ranges::find(sends, x.id, &direct_process::pending_send::number)->acked = x.acked;
  for (; !sends.empty() && sends.front().acked; sends.erase(sends.begin()))
    notify(process, [acked = status_of(*sends.front().acked)](auto& events) { events.ack(acked); });
}

void layer::on_packet(island_id source, std::uint16_t channel, byte_view body, instant now) {
  now_ = now;
  if (channel <= 0xff) {
    take(messages_.on_segment(source, body, now, [this](std::uint8_t am_type) {
      return rest_owner_ || owners_.contains(am_type) || am_type == network::am::outputs_wanted;
    }));
  } else if (channel == transport::tunnel_channel) {
    take(tunnels_.on_packet(source, body, now));
  } else {
    ++counters_.unknown_channel;
    note_loss(loss::no_program);
  }
}

// Channels: Network's inside the island, tunnels to elsewhere.

void layer::connect(channel_request who, mote_address destination,
                    std::chrono::milliseconds interval, std::size_t size, std::uint8_t qos) {
  if (const auto most = stream::latency_asked(qos))
    latencies_asked_[who] = *most;
  const bool is_near =
      destination.island == self().island && destination.mote != no_mote && config_.self != no_mote;
  if (is_near) {
    outputs_.emplace_back(channel_wanted{who, destination.mote, interval, size});
    return;
  }
  auto [id, todo] = tunnels_.connect(destination, now_);
  connecting_[id] = who;
  take(std::move(todo));
}

void layer::take(transport::tunnels_outputs todo, bool in_slot) {
  for (auto& x : todo) {
    if (auto* packet = std::get_if<transport::packet_out>(&x)) {
      outputs_.emplace_back(transport::to_network{packet->destination, transport::tunnel_channel,
                                                  std::move(packet->octets), in_slot});
    } else if (const auto* open = std::get_if<transport::tunnel_connected>(&x)) {
      if (const auto who = connecting_.extract(open->id); who)
        on_connected(*who, handle_of(open->id), now_);
    } else if (const auto* offered = std::get_if<transport::tunnel_accepted>(&x)) {
      on_accepted(handle_of(offered->id), offered->source, now_);
    } else if (auto* content = std::get_if<transport::tunnel_received>(&x)) {
      on_channel_octets(handle_of(content->id), content->content, now_);
    } else {
      const auto id = std::get<transport::tunnel_ended>(x).id;
      if (const auto who = connecting_.extract(id); who)
        on_connect_failed(*who, now_);
      else
        on_channel_closed(handle_of(id), now_);
    }
  }
}

void layer::send_on(stream::channel_handle channel, bytes octets, bool in_slot) {
  const mote_address sender{island_.value_or(config_.home), config_.self};
  const acting_on its_copies(begin_message(kind_of(channel), sender, {}));
  if (!is_tunnel(channel))
    outputs_.emplace_back(channel_packet{channel, std::move(octets), in_slot});
  else if (auto todo = tunnels_.send(tunnel_of(channel), octets, now_))
    take(*std::move(todo), in_slot);
}

void layer::disconnect(stream::channel_handle channel) {
  is_synaptic_.erase(channel);
  latency_bounds_.erase(channel);
  if (is_tunnel(channel))
    take(tunnels_.close(tunnel_of(channel)));
  else
    outputs_.emplace_back(channel_unwanted{channel});
}

/// Whoever has asked for less than the route can promise does not get it.
void layer::on_connected(channel_request who, stream::channel_handle channel, instant now) {
  now_ = now;
  if (const auto asked = latencies_asked_.extract(who); asked) {
    const auto bound = latency_bound(channel);
    if (!bound || *bound > *asked) {
      ++counters_.too_slow;
      disconnect(channel);
      on_connect_failed(who, now);
      return;
    }
  }
  is_synaptic_[channel] = who.is_synaptic;
  if (who.is_synaptic)
    take(synaptic_.on_connected(synaptic::descriptor(who.descriptor), channel, now));
  else
    take(streams_.on_connected(stream::descriptor(who.descriptor), channel, now));
}

void layer::on_connect_failed(channel_request who, instant now) {
  now_ = now;
  latencies_asked_.erase(who);
  if (who.is_synaptic)
    take(synaptic_.on_connect_failed(synaptic::descriptor(who.descriptor)));
  else
    take(streams_.on_connect_failed(stream::descriptor(who.descriptor)));
}

/// Whose it is the first packet says.
void layer::on_accepted(stream::channel_handle channel, mote_address source, instant now) {
  now_ = now;
  unclaimed_.emplace_back(channel, source);
  if (unclaimed_.size() <= config_.unclaimed_max)
    return;
  ++counters_.unclaimed;
  const auto oldest = unclaimed_.front().first;
  unclaimed_.erase(unclaimed_.begin());
  disconnect(oldest);
}

void layer::on_channel_octets(stream::channel_handle channel, byte_view octets, instant now) {
  now_ = now;
  const auto fresh = std::ranges::find(unclaimed_, channel,
                                       &std::pair<stream::channel_handle, mote_address>::first);
  if (fresh != unclaimed_.end()) {
    const auto source = fresh->second;
    unclaimed_.erase(fresh);
    const bool learns = synaptic::is_synaptic(octets);
    is_synaptic_[channel] = learns;
    if (learns)
      take(synaptic_.on_accepted(channel, source, now, messages_.far_slack(source)));
    else
      take(streams_.on_accepted(channel, source, now, messages_.far_slack(source)));
  }
  const auto user = is_synaptic_.find(channel);
  if (user == is_synaptic_.end()) {
    note_loss(loss::channel_closed);
    return;
  }
  note_arrival(kind_of(channel),
               is_tunnel(channel) ? tunnels_.peer_of(tunnel_of(channel)) : std::nullopt);
  if (user->second)
    take(synaptic_.on_channel_octets(channel, octets));
  else
    take(streams_.on_channel_octets(channel, octets, now));
}

void layer::on_channel_closed(stream::channel_handle channel, instant now) {
  now_ = now;
  std::erase_if(unclaimed_, [channel](const auto& x) { return x.first == channel; });
  latency_bounds_.erase(channel);
  const auto user = is_synaptic_.extract(channel);
  if (!user)
    return;
  if (*user)
    take(synaptic_.on_channel_closed(channel));
  else
    take(streams_.on_channel_closed(channel));
}

// Streams.

std::optional<duration> layer::latency_bound(stream::descriptor stream) const {
  const auto channel = streams_.channel_of(stream);
  return channel ? latency_bound(*channel) : std::nullopt;
}

/// What comes over gateways takes as long as twice the set-up did, there and back, more for radios
/// that sleep at another moment, and for what is before it in queues.
std::optional<duration> layer::latency_bound(stream::channel_handle channel) const {
  constexpr duration queues = 250ms;
  if (is_tunnel(channel)) {
    const auto route = tunnels_.route_of(tunnel_of(channel));
    if (!route)
      return messages_.config().lifetime;
    const auto slack = messages_.slack_to(route->peer);
    return std::min(messages_.config().lifetime, 2 * route->round_trip + queues) + slack;
  }
  const auto found = latency_bounds_.find(channel);
  return found == latency_bounds_.end() ? std::nullopt : std::optional(found->second);
}

int layer::take_open(std::size_t process, stream::answer x) {
  if (x.refused) {
    refuse();
    return -1;
  }
  stream_owners_[x.stream] = process;
  take(std::move(x.todo));
  return x.stream.value;
}

void layer::take(stream::outputs todo) {
  for (auto& each : todo) {
    if (const auto* request = std::get_if<stream::connect_channel>(&each)) {
      connect({false, request->stream.value}, request->destination, request->interval,
              request->size, request->qos);
    } else if (auto* packet = std::get_if<stream::send_on_channel>(&each)) {
      send_on(packet->channel, std::move(packet->octets));
    } else if (const auto* over = std::get_if<stream::disconnect>(&each)) {
      disconnect(over->channel);
    } else if (const auto* wanted = std::get_if<stream::sample>(&each)) {
      outputs_.emplace_back(sample_wanted{wanted->stream, wanted->transducer});
    } else if (const auto* opened = std::get_if<stream::open_done>(&each)) {
      notify_owner(stream_owners_, opened->stream, [x = *opened](auto& events) {
        events.openRemoteDone(x.stream.value, x.name, status_of(x.success));
      });
      if (!opened->success)
        stream_owners_.erase(opened->stream);
    } else {
      on_read(std::get<stream::read_done>(each));
    }
  }
}

/// A sensor stream may be opened before the island is known; its records leave with it (STR-07).
void layer::on_read(stream::read_done& x) {
  if (island_ && streams_.is_sensor(x.stream))
    set_island(x.content, *island_);
  notify_owner(stream_owners_, x.stream, [done = std::move(x)](auto& events) {
    events.readDone(done.stream.value, done.content, status_of(done.success));
  });
}

void layer::on_sample(stream::descriptor stream, const stream::sensor_record& x, instant now) {
  now_ = now;
  take(streams_.on_sample(stream, x));
}

// What the mote carries.

void layer::on_transducers(std::size_t process, std::vector<std::int16_t> counts,
                           std::uint32_t time_ms, instant now) {
  now_ = now;
  notify(process,
         [counts = std::move(counts), time_ms](auto& x) { x.transducersRead(counts, time_ms); });
}

void layer::on_actuator(std::size_t process, const std::string& name, std::uint8_t state,
                        bool obeyed, instant now) {
  now_ = now;
  movers_[name] = process;
  note(process, {.what = program_note::kind::actuator_changed,
                 .actuator = name,
                 .state = state,
                 .yes = obeyed});
  notify(process, [=](auto& x) { x.actuatorChanged(name, state, obeyed); });
}

void layer::on_actuator_arrived(const std::string& name, std::uint8_t state, instant now) {
  if (const auto mover = movers_.find(name); mover != movers_.end())
    on_actuator(mover->second, name, state, true, now);
}

// Synaptic channels.

int layer::create(std::size_t process, bool is_out, mote_address other, std::uint8_t size,
                  const synaptic::parameters& params) {
  if (!may_talk()) {
    refuse();
    return -1;
  }
  const auto slack = messages_.far_slack(other);
  auto x = is_out ? synaptic_.create_out(self(), other, size, params, now_, slack)
                  : synaptic_.create_in(self(), other, size, params, now_, slack);
  if (x.refused) {
    refuse();
    return -1;
  }
  synaptic_owners_[x.channel] = process;
  take(std::move(x.todo));
  return x.channel.value;
}

void layer::take(synaptic::outputs todo) {
  for (auto& each : todo) {
    if (const auto* request = std::get_if<synaptic::connect_channel>(&each)) {
      connect({true, request->channel.value}, request->destination, request->interval,
              request->size, request->qos);
    } else if (auto* packet = std::get_if<synaptic::send_on_channel>(&each)) {
      send_on(packet->channel, std::move(packet->octets), packet->in_slot);
    } else if (const auto* over = std::get_if<synaptic::disconnect>(&each)) {
      disconnect(over->channel);
    } else if (const auto* done = std::get_if<synaptic::create_done>(&each)) {
      notify_owner(synaptic_owners_, done->channel, [x = *done](auto& events) {
        if (x.is_out)
          events.createSynChannelOutDone(x.channel.value, status_of(x.success));
        else
          events.createSynChannelInDone(x.channel.value, status_of(x.success));
      });
      if (!done->success)
        synaptic_owners_.erase(done->channel);
    } else if (const auto* update = std::get_if<synaptic::input_update>(&each)) {
      notify_owner(synaptic_owners_, update->channel, [x = *update](auto& events) {
        events.syn_input_update(x.channel.value, x.index, x.status);
      });
    } else {
      const auto failed = std::get<synaptic::channel_failed>(each).channel;
      notify_owner(synaptic_owners_, failed,
                   [failed](auto& events) { events.synChannelFailed(failed.value); });
    }
  }
}

/// Inputs are reported before the tick: who computes at the tick has them. Programs get it before
/// anything is sent: what they write leaves at this tick, in any slot.
void layer::on_tick(std::uint32_t tick, instant now) {
  now_ = now;
  take(synaptic_.on_tick(tick, now));
  for (std::size_t i = 0; i < programs_.size(); ++i) {
    if (programs_[i]->wants_ticks())
      notify(i, [tick](auto& x) { x.clock_tick(tick); });
  }
  dispatch();
}

std::vector<layer::vector_end> layer::vector_ends() const {
  std::vector<vector_end> found;
  for (const auto& x : synaptic_.out_ends()) {
    const bool is_near = x.channel && !is_tunnel(*x.channel);
    found.push_back({x.size, x.channel.has_value(), is_near ? x.channel : std::nullopt});
  }
  return found;
}

bool layer::wants_ticks() const {
  return synaptic_.open_channels() > 0 ||
         std::ranges::any_of(programs_, [](const auto& x) { return x->wants_ticks(); });
}

// Time.

void layer::on_time(instant now) {
  now_ = now;
  take(messages_.on_time(now));
  take(tunnels_.on_time(now));
  take(streams_.on_time(now));
  take(synaptic_.on_time(now));
}

std::optional<instant> layer::deadline() const {
  return earliest(earliest(messages_.deadline(), tunnels_.deadline()),
                  earliest(streams_.deadline(), synaptic_.deadline()));
}

std::size_t layer::footprint() const {
  return messages_.footprint() + tunnels_.footprint() + streams_.footprint() +
         synaptic_.footprint() + config_.unclaimed_max * 8 + 1 + outputs_wanted_max * 6;
}

} // namespace rubicon::communication
