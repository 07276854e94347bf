#include "mote/node.hpp"

#include <algorithm>
#include <utility>

#include "core/account/message_ledger.hpp"
#include "core/overloads.hpp"
#include "mote/stack/channel_handle.hpp"
#include "network/clock/tick_plan.hpp"
#include "network/island_packet.hpp"

namespace rubicon::mote {

namespace {

descriptor describe(const node_config& config) {
  descriptor x;
  x.type = config.type;
  for (const auto& transducer : config.transducers)
    x.transducer_mask |= 1U << static_cast<unsigned>(transducer.kind);
  for (const auto& actuator : config.actuators)
    x.actuator_mask |= 1U << static_cast<unsigned>(actuator.kind);
  x.keep_alive_ms = static_cast<std::uint32_t>(
      std::chrono::duration_cast<std::chrono::milliseconds>(config.keep_alive).count());
  x.device = config.device;
  return x;
}

/// A description that a program has made, with the device.
bytes with_device(bytes description, std::uint32_t device) {
  const auto given = decode_descriptor(description);
  if (!given || device == 0 || given->device == device)
    return description;
  const auto field = encode(descriptor{.device = device});
  description.insert(description.end(),
                     field.end() - static_cast<std::ptrdiff_t>(device_field_size), field.end());
  return description;
}

/// Many may find a route to the sink at the same beacon: so long they take to join.
duration join_spread(const network::neighbours& links) {
  return links.is_full() ? 2s : static_cast<duration::rep>(links.all().size()) * duration(20ms);
}

communication::layer_config layer_of(const node_config& config, std::uint32_t incarnation) {
  auto x = config.tables->layer;
  x.self = config.id;
  x.incarnation = incarnation;
  x.transducer_mask = describe(config).transducer_mask;
  return x;
}

network::router_config network_of(const node_config& config) {
  auto x = config.tables->network;
  x.self = config.id;
  x.duty = config.duty.common();
  x.wake = config.access.wake;
  x.backbone = config.backbone;
  return x;
}

} // namespace

node::~node() = default;

node::node(std::shared_ptr<const node_config> config, crystal crystal, const nonvolatile& store,
           random_stream rng, instant now)
    : config_(std::move(config)), crystal_(crystal), store_(store), rng_(rng),
      layer_(layer_of(*config_, store_.starts), random_stream(rng_.next())),
      packets_(network_of(*config_), random_stream(rng_.next()), now), duty_(config_->duty, false),
      devices_(config_->transducers, config_->actuators,
               {config_->place, config_->transducer_seed}) {}

communication::interface node::attach(communication::communication_events& events,
                                      std::string name) {
  return layer_.use().attach(events, std::move(name));
}

// Joining.

node_outputs node::start(instant now) {
  node_outputs out{store_nonvolatile{begin_life(store_)}};
  layer_.use().on_initialised(true, now);
  if (config_->joins_alone)
    ask_to_join(encode(describe(*config_)), out, now);
  settle(out, now);
  return out;
}

void node::ask_to_join(bytes description, node_outputs& out, instant now) {
  join_config config;
  config.keep_alive = config_->keep_alive * 3 / 2;
  member_.prepare(join_client(config, with_device(std::move(description), config_->device),
                              store_.starts, random_stream(rng_.next()), config_->device));
  take(packet_service_outputs{}, out, now);
}

node_outputs node::leave(instant now) {
  node_outputs out;
  take(member_.leave(), out, now);
  layer_.use().on_left(now);
  settle(out, now);
  return out;
}

void node::take(join_outputs from_join, node_outputs& out, instant now) {
  const overloads act{
      [&](const to_registrar& x) {
        take(packets_.send_management(packets_.router().tree().root(), encode(x.message), now), out,
             now);
      },
      [&](const island_joined& x) {
        member_.on_joined(x);
        slot_.on_joined();
        layer_.use().on_joined(x.island, now);
        duty_.set_member(true);
        out.emplace_back(membership{true, x.island});
      },
      [&](const island_lost&) {
        layer_.use().on_left(now);
        slot_.on_lost();
        duty_.set_member(false);
        out.emplace_back(membership{});
      },
      [&](const join_refused&) {
        is_silenced_ = true;
        out.emplace_back(radio_switch{false});
        out.emplace_back(address_taken{});
      },
      [&](const join_resumed&) {
        is_silenced_ = false;
        out.emplace_back(radio_switch{radio_wanted_});
      },
  };
  for (const auto& x : from_join)
    std::visit(act, x);
}

void node::on_management(const management_in& x, node_outputs& out, instant now) {
  const auto message = decode_management(x.octets);
  if (const auto* grant = message ? std::get_if<slot_grant>(&*message) : nullptr)
    slot_.on_grant(grant->slot, rng_, now);
  else if (message)
    take(member_.client().on_message(x.origin, *message, now, packets_.router().tree().root()), out,
         now);
  else
    ++counters_.malformed;
}

// What comes.

node_outputs node::on_frame(mote_id source, std::uint8_t am_type, byte_view payload, instant sfd,
                            instant now, network::medium over) {
  node_outputs out;
  duty_.on_frame(am_type, payload, now);
  take(packets_.on_frame(source, am_type, payload, sfd, now, over), out, now);
  settle(out, now);
  return out;
}

node_outputs node::on_sent(std::uint64_t token, bool acked, unsigned transmissions, instant now) {
  node_outputs out;
  duty_.on_sent(token);
  take(packets_.on_sent(token, acked, transmissions, now), out, now);
  settle(out, now);
  return out;
}

node_outputs node::on_battery_low(instant now) {
  node_outputs out;
  take(member_.on_battery_low(now), out, now);
  settle(out, now);
  return out;
}

node_outputs node::on_signal(mote_id source, int rssi_dbm, instant now) {
  if (source != packets_.router().tree().parent())
    return {};
  devices_.set_parent_dbm(static_cast<std::int16_t>(rssi_dbm));
  auto changed = member_.on_signal(rssi_dbm, now);
  if (!changed)
    return {};
  node_outputs out;
  take(*std::move(changed), out, now);
  settle(out, now);
  return out;
}

node_outputs node::on_time(instant now) {
  node_outputs out;
  take(packets_.on_time(now), out, now);
  auto& join = member_.client();
  join.set_turn_wait(packets_.router().turn_wait(now));
  if (member_.takes_start(now))
    take(join.start(packets_.router().tree().hops(), now), out, now);
  take(join.on_time(now), out, now);
  tick(now);
  send_slot_notice(out, now);
  update_slack(now);
  if (const auto due = layer_.deadline(); due && *due <= now)
    layer_.use().on_time(now);
  for (auto& x : devices_.on_time(now)) {
    layer_.use().devices().on_actuator_arrived(x.name, x.state, now);
    out.emplace_back(std::move(x));
  }
  send_paced(out, now);
  send_slotted(out, now);
  settle(out, now);
  return out;
}

instant node::deadline() const {
  auto due = *earliest(packets_.deadline(), earliest(member_.deadline(), clock_.deadline()));
  due = *earliest(due, earliest(layer_.deadline(), duty_.deadline()));
  due = *earliest(due, earliest(slot_.deadline(), pacer_.deadline()));
  return *earliest(due, devices_.deadline());
}

/// The RUBICON clock (CLK-01..05).
void node::tick(instant now) {
  const auto& shared = packets_.router().clock();
  const auto setting = shared.tick(now);
  if (!shared.synchronised() || !setting)
    return;
  if (!layer_.wants_ticks()) {
    clock_.stop();
    update_slot(now);
    return;
  }
  const network::tick_plan plan(setting->period);
  const auto slot = plan.begin(slot_.granted());
  layer_.use().vectors().set_slot(
      slot.value_or(plan.has_free_part() ? plan.free_from(plan.shares) : 0ns));
  if (const auto next = clock_.update(now, shared.at(now), *setting)) {
    slot_.begin_tick(slot ? slot_.granted().units * plan.unit : 0ns);
    layer_.use().vectors().on_tick(next->number, now);
  }
  update_slot(now);
}

/// Ticks count from now on, or no more. @returns whether that is new
bool node::follow_ticks(instant now) {
  const bool had_ticks = clock_.deadline().has_value();
  if (layer_.wants_ticks() != had_ticks)
    tick(now);
  return clock_.deadline().has_value() != had_ticks;
}

/// Whether the sink is to be asked for another slot. In an island that sleeps there are none: its
/// channels have schedules, or it is unknown when a receiver is on.
void node::update_slot(instant now) {
  if (!member_.joined() || config_->duty.enabled || config_->access.wake > 0s)
    return;
  const auto& vectors = layer_.view().ports().synaptic;
  std::vector<vector_flow> flows;
  bool all_connected = true;
  for (const auto& x : vectors.vector_ends()) {
    const auto hops = x.channel ? packets_.router().paths().hops(channel_of(*x.channel)) : 0;
    if (x.connected)
      flows.push_back({x.size, hops.value_or(1)});
    all_connected = all_connected && x.connected;
  }
  const auto units = units_of(flows, vectors.core().config().packet_max, config_->access);
  slot_.set_demand(units, all_connected, rng_, now);
}

void node::send_slot_notice(node_outputs& out, instant now) {
  const auto& router = packets_.router();
  const auto answer_wait = 2 * (1 + router.tree().hops()) * router.turn_wait(now);
  const auto notice = slot_.take_notice(answer_wait, rng_, now);
  if (!notice)
    return;
  member_.client().on_sent(now);
  take(packets_.send_management(router.tree().root(), encode(*notice), now), out, now);
}

void node::take(packet_service_outputs from_packets, node_outputs& out, instant now) {
  const overloads act{
      [&](network::frame_out& x) { duty_.submit(std::move(x)); },
      [&](const management_in& x) { on_management(x, out, now); },
      [&](const packet_in& x) { on_packet(x.packet, now); },
      [&](const network::clock_corrected&) { tick(now); },
      [&](const network::channel_connected& x) {
        set_latency_bound(x.channel);
        if (const auto who = connecting_.extract(x.channel); who)
          layer_.use().channels().on_connected(*who, handle_of(x.channel), now);
      },
      [&](const network::channel_accepted& x) {
        if (member_.joined()) { // before that it has no address
          set_latency_bound(x.channel);
          layer_.use().channels().on_accepted(handle_of(x.channel),
                                              {member_.island(), x.channel.source}, now);
        } else {
          take(packets_.router().refuse(x.channel, now), out, now);
        }
      },
      [&](const network::channel_reserved& x) { duty_.reserve(x); },
      [&](const network::channel_received& x) {
        duty_.on_received(x.channel);
        layer_.use().channels().on_octets(handle_of(x.channel), x.content, now);
      },
      [&](const network::channel_ended& x) {
        if (const auto who = connecting_.extract(x.channel); who)
          layer_.use().channels().on_connect_failed(*who, now);
        else
          layer_.use().channels().on_closed(handle_of(x.channel), now);
      },
  };
  for (auto& x : from_packets)
    std::visit(act, x);
  if (member_.waits_for_route() && packets_.router().tree().has_route())
    member_.start_at(now + rng_.between(0s, join_spread(packets_.router().links())));
}

void node::take(network::router_outputs from_router, node_outputs& out, instant now) {
  take(packets_.carry(std::move(from_router), now), out, now);
}

void node::on_packet(const network::island_packet& x, instant now) {
  const bool is_ours = x.mote == config_->id || x.mote == broadcast_mote;
  if (member_.joined() && is_ours) {
    layer_.use().on_packet(x.island, x.channel, x.body, now);
  } else {
    ++counters_.misdirected;
    note_loss(loss::no_program);
  }
}

// What programs want.

node_outputs node::settle(instant now) {
  node_outputs out;
  static_cast<void>(layer_.use()); // programs have
  settle(out, now);
  return out;
}

void node::settle(node_outputs& out, instant now) {
  do {
    for (auto wanted = layer_.take_outputs(); wanted; wanted = layer_.take_outputs()) {
      for (auto& x : *wanted)
        perform(x, out, now);
    }
  } while (follow_ticks(now));
  for (auto& x : duty_.update(now, packets_.router().clock(), packets_.router().search())) {
    const auto* power = std::get_if<radio_switch>(&x);
    if (power != nullptr)
      radio_wanted_ = power->on;
    if (power == nullptr || !is_silenced_)
      std::visit([&out](auto& y) { out.emplace_back(std::move(y)); }, x);
  }
}

// Transducers and actuators.

/// What a datum of now is stamped with: the time that peers share if it is known, else the
/// island's, else our own; the low 32 bits of its milliseconds (IF-06, CLK-08).
std::uint32_t node::time_ms(instant now) const {
  const auto& shared = packets_.router().clock();
  const auto island =
      shared.synchronised() ? shared.at(now).time_since_epoch() : now.time_since_epoch();
  return static_cast<std::uint32_t>(shared.network_time(now).value_or(island) /
                                    std::chrono::milliseconds(1));
}

void node::carry_out(const communication::sample_wanted& x, instant now) {
  const auto ahead = crystal_.own({}) - instant{}; // streams go by the mote's crystal
  const auto count = read(static_cast<device::quantity>(x.transducer), now - ahead);
  layer_.use().devices().on_sample(
      x.stream, {{member_.island(), config_->id}, time_ms(now), count.value_or(0)}, now);
}

void node::carry_out(const communication::transducers_wanted& x, instant now) {
  std::vector<std::int16_t> counts;
  for (const auto kind : x.kinds)
    counts.push_back(read(kind, crystal_.real(now)).value_or(0));
  layer_.use().devices().on_transducers(x.process, std::move(counts), time_ms(now), now);
}

void node::carry_out(const communication::actuator_wanted& x, node_outputs& out, instant now) {
  const bool obeyed = devices_.set(x.name, x.state, now);
  const auto state = devices_.state(x.name, now).value_or(0);
  if (obeyed && state == x.state)
    out.emplace_back(actuator_arrived{x.name, state});
  layer_.use().devices().on_actuator(x.process, x.name, state, obeyed, now);
}

std::size_t node::footprint() const {
  constexpr std::size_t join_octets = 32;
  constexpr std::size_t clock_octets = 12;
  return packets_.footprint() + layer_.view().footprint() + join_octets + clock_octets +
         duty_cycle::footprint(config_->tables->network.paths.entries_max);
}

} // namespace rubicon::mote
