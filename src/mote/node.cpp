#include "mote/node.hpp"

#include <algorithm>
#include <utility>

#include "core/account/message_ledger.hpp"
#include "core/overloads.hpp"
#include "device/transducer.hpp"
#include "network/clock/tick_plan.hpp"
#include "network/island_packet.hpp"

namespace rubicon::mote {

namespace {

constexpr duration expiry_min = 5min; ///< of a channel without packets,
constexpr int expiry_intervals = 10;  ///< or so many of its intervals

// SYN-16: who sends vectors asks the sink for a slot, and again before the sink forgets it.
constexpr duration notice_spread = 500ms;
constexpr duration notice_period = 60s;
constexpr duration grant_wait = 2s;   ///< beside turns
constexpr duration settle_wait = 10s; ///< for channels that come about one after the other

/// What a scheduled packet takes from end to end: ten hops, and some more.
constexpr duration route_max = 10 * network::channel_slot;

constexpr std::size_t paced_max = 4;   ///< packets of one channel that wait for its turn,
constexpr std::size_t paced_usual = 2; ///< and so many without hurry

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

/// A description that a program has made tells the device too.
bytes with_device(bytes description, std::uint32_t device) {
  const auto told = decode_descriptor(description);
  if (!told || device == 0 || told->device == device)
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

/// A channel of Network, as the layer knows it.
stream::channel_handle handle_of(network::channel_id x) {
  return stream::channel_handle(network::number_of(x));
}

network::channel_id channel_of(stream::channel_handle x) {
  return network::channel_of(x.value);
}

/// Where radios sleep all else goes in the common window: a channel whose turns come again at the
/// same place of each keeps out of it, with all of its route.
island_time beside_the_window(island_time first, duration interval, const duty_config& duty,
                              random_stream& rng) {
  using std::chrono::microseconds;
  const auto begin = duty.window + route_max / 5;
  const auto end = interval - route_max;
  if (!duty.enabled || begin >= end || duty.period % interval != 0ns)
    return first;
  const auto phase = first.time_since_epoch() % in_us(interval);
  if (phase >= begin && phase <= end)
    return first;
  return first - phase + in_us(interval + rng.between(begin, end));
}

} // namespace

node::~node() = default;

node::node(std::shared_ptr<const node_config> config, crystal crystal, const nonvolatile& store,
           random_stream rng, instant now)
    : config_(std::move(config)), crystal_(crystal), place_(config_->place), rng_(rng),
      store_(store) {
  auto above = config_->tables->layer;
  above.self = config_->id;
  above.incarnation = incarnation();
  above.transducer_mask = describe(*config_).transducer_mask;
  layer_.emplace(above, random_stream(rng_.next()));
  auto network = config_->tables->network;
  network.self = config_->id;
  network.duty = config_->duty.common();
  network.wake = config_->access.wake;
  network.backbone = config_->backbone;
  packets_ = packet_service(network, random_stream(rng_.next()), now);
  duty_ = duty_cycle(config_->duty, false);
  for (const auto& x : config_->actuators)
    actuators_.emplace(x.name, device::actuator(x));
}

communication::interface node::attach(communication::communication_events& events,
                                      std::string name) {
  return use_layer().attach(events, std::move(name));
}

// Joining.

node_outputs node::start(instant now) {
  node_outputs out{store_nonvolatile{begin_life(store_)}};
  use_layer().on_initialised(true, now);
  if (config_->joins_alone)
    ask_to_join(encode(describe(*config_)), out, now);
  settle(out, now);
  return out;
}

void node::ask_to_join(bytes description, node_outputs& out, instant now) {
  join_config config;
  config.keep_alive = config_->keep_alive * 3 / 2;
  join_ = join_client(config, with_device(std::move(description), config_->device), incarnation(),
                      random_stream(rng_.next()), config_->device);
  wants_to_join_ = true;
  take(packet_service_outputs{}, out, now);
}

node_outputs node::leave(instant now) {
  node_outputs out;
  wants_to_join_ = false;
  joins_at_.reset();
  take(join_.leave(), out, now);
  use_layer().on_left(now);
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
        island_ = x.island;
        slot_ = {};
        gateways_ = {gateway_of(island_)};
        for (const auto alias : x.aliases)
          gateways_.push_back(gateway_of(alias));
        units_told_ = 0;
        use_layer().on_joined(x.island, now);
        duty_.set_member(true);
        out.emplace_back(membership{true, x.island});
      },
      [&](const island_lost&) {
        use_layer().on_left(now);
        slot_ = {};
        tells_at_.reset();
        duty_.set_member(false);
        out.emplace_back(membership{});
      },
      [&](const join_refused&) {
        refused_ = true;
        out.emplace_back(radio_switch{false});
        out.emplace_back(address_taken{});
      },
      [&](const join_resumed&) {
        refused_ = false;
        out.emplace_back(radio_switch{radio_wanted_});
      },
  };
  for (const auto& x : from_join)
    std::visit(act, x);
}

void node::on_management(const management_in& x, node_outputs& out, instant now) {
  const auto message = decode_management(x.octets);
  if (const auto* grant = message ? std::get_if<slot_grant>(&*message) : nullptr)
    on_grant(*grant, now);
  else if (message)
    take(join_.on_message(x.origin, *message, now, packets_.router().tree().root()), out, now);
  else
    ++counters_.malformed;
}

/// A refusal stands until the next notice.
void node::on_grant(const slot_grant& x, instant now) {
  slot_ = x.slot;
  if (tells_at_ && (slot_.units == units_told_ || slot_.units == 0))
    tells_at_ = next_notice(now);
}

/// Nothing while there is nothing to say.
std::optional<instant> node::next_notice(instant now) {
  return units_told_ > 0 ? std::optional(now + notice_period - rng_.between(0s, notice_period / 4))
                         : std::nullopt;
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
  condition_.battery_low = true;
  take(join_.tell(condition_, now), out, now);
  settle(out, now);
  return out;
}

/// A mote that is carried away is told by the signal of its parent long before frames get lost:
/// then it is too late to say so.
node_outputs node::on_signal(mote_id source, int rssi_dbm, instant now) {
  constexpr int weak_below_dbm = -88; // radios hear down to -95 dBm at least (docs/tinyos.md 7.1)
  constexpr int strong_from_dbm = -84;
  const bool is_weak = rssi_dbm < (condition_.links_weak ? strong_from_dbm : weak_below_dbm);
  if (source != packets_.router().tree().parent())
    return {};
  parent_dbm_ = static_cast<std::int16_t>(rssi_dbm);
  if (is_weak == condition_.links_weak)
    return {};
  node_outputs out;
  condition_.links_weak = is_weak;
  take(join_.tell(condition_, now), out, now);
  settle(out, now);
  return out;
}

node_outputs node::on_time(instant now) {
  node_outputs out;
  take(packets_.on_time(now), out, now);
  join_.set_turn_wait(packets_.router().turn_wait(now));
  if (joins_at_ && *joins_at_ <= now) {
    joins_at_.reset();
    take(join_.start(packets_.router().tree().hops(), now), out, now);
  }
  take(join_.on_time(now), out, now);
  tick(now);
  tell_slot(out, now);
  heed_waits(now);
  if (const auto due = layer_deadline(); due && *due <= now)
    use_layer().on_time(now);
  for (auto& [name, x] : actuators_) {
    if (!x.on_time(now))
      continue;
    out.emplace_back(actuator_arrived{name, x.target()});
    use_layer().devices().on_actuator_arrived(name, x.target(), now);
  }
  send_paced(out, now);
  send_slotted(out, now);
  settle(out, now);
  return out;
}

instant node::deadline() const {
  auto due = *earliest(packets_.deadline(), earliest(join_.deadline(), clock_.deadline()));
  due = *earliest(due, earliest(layer_deadline(), duty_.deadline()));
  due = *earliest(due, earliest(joins_at_, tells_at_));
  for (const auto& [channel, x] : paced_)
    due = std::min(due, x.due);
  if (!slotted_.empty())
    due = std::min(due, slotted_.front().due);
  for (const auto& [name, x] : actuators_)
    due = *earliest(due, x.deadline());
  return due;
}

/// The RUBICON clock (CLK-01..05).
void node::tick(instant now) {
  const auto& shared = packets_.router().clock();
  const auto setting = shared.tick(now);
  if (!shared.synchronised() || !setting)
    return;
  if (!layer_wants_ticks()) {
    clock_.stop();
    watch_slots(now);
    return;
  }
  const network::tick_plan plan(setting->period);
  const auto slot = plan.begin(slot_);
  use_layer().vectors().set_slot(
      slot.value_or(plan.has_free_part() ? plan.free_from(plan.shares) : 0ns));
  if (const auto next = clock_.update(now, shared.at(now), *setting)) {
    slot_left_ = slot ? slot_.units * plan.unit : 0ns;
    use_layer().vectors().on_tick(next->number, now);
  }
  watch_slots(now);
}

/// When a packet that is under way for so long may leave in our slot of this tick; nothing: what is
/// left of it is too short, so that the packet waits as others do.
std::optional<instant> node::take_slot(duration passage, instant now) {
  if (slot_left_ + config_->access.space < passage)
    return std::nullopt;
  slot_left_ -= passage;
  const auto begin = std::max(now, slot_at_);
  slot_at_ = begin + passage;
  return begin;
}

/// Of each tick, for our vectors. Channels come about one after the other, and are counted
/// together.
std::uint16_t node::units_wanted(instant now) {
  std::vector<vector_flow> flows;
  bool all_connected = true;
  for (const auto& x : layer_->ports().synaptic.vector_ends()) {
    const auto hops = x.channel ? packets_.router().paths().hops(channel_of(*x.channel)) : 0;
    if (x.connected)
      flows.push_back({x.size, hops.value_or(1)});
    all_connected = all_connected && x.connected;
  }
  if (all_connected)
    settles_.reset();
  else if (!settles_)
    settles_ = now + settle_wait;
  if (settles_ && now < *settles_)
    return units_told_;
  return units_of(flows, layer_->ports().synaptic.core().config().packet_max, config_->access);
}

/// Ticks count from now on, or no more. @returns whether that is new
bool node::heed_ticks(instant now) {
  const bool had_ticks = clock_.deadline().has_value();
  if (layer_wants_ticks() != had_ticks)
    tick(now);
  return clock_.deadline().has_value() != had_ticks;
}

/// Whether the sink is to be asked for another slot. In an island that sleeps there are none: its
/// channels have schedules, or it is unknown when a receiver is on.
void node::watch_slots(instant now) {
  if (!joined() || config_->duty.enabled || config_->access.wake > 0s)
    return;
  const auto units = units_wanted(now);
  if (std::exchange(units_told_, units) != units)
    tells_at_ = now + rng_.between(0s, notice_spread);
}

void node::tell_slot(node_outputs& out, instant now) {
  if (!tells_at_ || *tells_at_ > now)
    return;
  tells_at_.reset();
  const auto& router = packets_.router();
  if (slot_.units == units_told_) // the sink answers to what it does not agree with
    tells_at_ = next_notice(now);
  else if (units_told_ > 0)
    tells_at_ = now + grant_wait + 2 * (1 + router.tree().hops()) * router.turn_wait(now);
  join_.on_sent(now);
  take(packets_.send_management(router.tree().root(), encode(slot_notice{units_told_, slot_}), now),
       out, now);
}

void node::take(packet_service_outputs from_packets, node_outputs& out, instant now) {
  const overloads act{
      [&](network::frame_out& x) { duty_.submit(std::move(x)); },
      [&](const management_in& x) { on_management(x, out, now); },
      [&](const packet_in& x) { on_packet(x.packet, now); },
      [&](const network::clock_corrected&) { tick(now); },
      [&](const network::channel_connected& x) {
        tell_latency(x.channel);
        if (const auto who = connecting_.extract(x.channel); who)
          use_layer().channels().on_connected(*who, handle_of(x.channel), now);
      },
      [&](const network::channel_accepted& x) {
        if (joined()) { // before that nobody here knows our address
          tell_latency(x.channel);
          use_layer().channels().on_accepted(handle_of(x.channel), {island_, x.channel.source},
                                             now);
        } else {
          take(packets_.router().refuse(x.channel, now), out, now);
        }
      },
      [&](const network::channel_reserved& x) { duty_.reserve(x); },
      [&](const network::channel_received& x) {
        duty_.on_received(x.channel);
        use_layer().channels().on_octets(handle_of(x.channel), x.content, now);
      },
      [&](const network::channel_ended& x) {
        if (const auto who = connecting_.extract(x.channel); who)
          use_layer().channels().on_connect_failed(*who, now);
        else
          use_layer().channels().on_closed(handle_of(x.channel), now);
      },
  };
  for (auto& x : from_packets)
    std::visit(act, x);
  if (wants_to_join_ && packets_.router().has_route()) {
    wants_to_join_ = false;
    joins_at_ = now + rng_.between(0s, join_spread(packets_.router().links()));
  }
}

void node::tell_latency(network::channel_id channel) {
  if (const auto bound = packets_.router().paths().latency_bound(channel))
    use_layer().channels().set_latency_bound(handle_of(channel), *bound);
}

void node::take(network::router_outputs from_router, node_outputs& out, instant now) {
  take(packets_.carry(std::move(from_router), now), out, now);
}

void node::on_packet(const network::island_packet& x, instant now) {
  const bool is_ours = x.mote == config_->id || x.mote == broadcast_mote;
  if (joined() && is_ours) {
    use_layer().on_packet(x.island, x.channel, x.body, now);
  } else {
    ++counters_.misdirected;
    note_loss(loss::no_program);
  }
}

// What programs want.

node_outputs node::settle(instant now) {
  node_outputs out;
  use_layer(); // programs have
  settle(out, now);
  return out;
}

communication::layer& node::use_layer() {
  layer_used_ = true;
  return *layer_;
}

std::optional<instant> node::layer_deadline() const {
  return layer_used_ ? layer_->deadline() : layer_deadline_;
}

bool node::layer_wants_ticks() const {
  return layer_used_ ? layer_->ports().synaptic.wants_ticks() : layer_wants_ticks_;
}

void node::settle(node_outputs& out, instant now) {
  do {
    while (std::exchange(layer_used_, false)) {
      ++program_turns_;
      auto wanted = layer_->take_outputs();
      layer_deadline_ = layer_->deadline();
      layer_wants_ticks_ = layer_->ports().synaptic.wants_ticks();
      for (auto& x : wanted)
        perform(x, out, now);
    }
  } while (heed_ticks(now));
  for (auto& x : duty_.update(now, packets_.router().clock(), packets_.router().search())) {
    const auto* power = std::get_if<radio_switch>(&x);
    if (power != nullptr)
      radio_wanted_ = power->on;
    if (power == nullptr || !refused_)
      std::visit([&out](auto& y) { out.emplace_back(std::move(y)); }, x);
  }
}

void node::perform(communication::layer_output& x, node_outputs& out, instant now) {
  std::visit(overloads{
                 [&](transport::to_network& y) { carry_in_slot(std::move(y), out, now); },
                 [&](const communication::channel_wanted& y) { connect(y, out, now); },
                 [&](communication::channel_packet& y) { pace(std::move(y), out, now); },
                 [&](const communication::channel_unwanted& y) {
                   take(packets_.router().disconnect(channel_of(y.channel), now), out, now);
                 },
                 [&](const communication::sample_wanted& y) { carry_out(y, now); },
                 [&](const communication::transducers_wanted& y) { carry_out(y, now); },
                 [&](const communication::actuator_wanted& y) { carry_out(y, out, now); },
                 [&](const communication::init_wanted&) { use_layer().on_initialised(true, now); },
                 [&](const communication::join_wanted& y) { ask_to_join(y.description, out, now); },
             },
             x);
}

/// Where radios sleep, a channel with a schedule carries a packet each time that the next mote
/// wakes up for it.
void node::pace(communication::channel_packet x, node_outputs& out, instant now) {
  const auto turn = duty_.next_turn(channel_of(x.channel), now, packets_.router().clock());
  if (!turn) {
    carry_in_slot(std::move(x), out, now);
    return;
  }
  auto& waiting = paced_[x.channel];
  if (waiting.packets.empty())
    waiting.due = *turn;
  if (waiting.packets.size() >= paced_max) {
    ++counters_.paced_out;
    note_loss(waiting.packets.front().second, loss::overtaken);
    waiting.packets.erase(waiting.packets.begin());
  }
  waiting.packets.emplace_back(std::move(x.octets), x.from);
}

/// Packets of vectors leave one after the other in our slot, if it has room for them; others at
/// once, which means in their turn.
template <class Packet>
void node::carry_in_slot(Packet x, node_outputs& out, instant now) {
  const auto begin = x.in_slot ? take_slot(passage_of(x), now) : std::nullopt;
  if (begin && *begin > now)
    slotted_.push_back({*begin, std::move(x)});
  else
    carry(std::move(x), begin.has_value(), out, now);
}

void node::send_slotted(node_outputs& out, instant now) {
  while (!slotted_.empty() && slotted_.front().due <= now) {
    auto next = std::move(slotted_.front());
    slotted_.erase(slotted_.begin());
    std::visit([&](auto& x) { carry(std::move(x), true, out, now); }, next.what);
  }
}

duration node::passage_of(const communication::channel_packet& x) const {
  const auto hops = packets_.router().paths().hops(channel_of(x.channel));
  return network::passage(x.octets.size(), hops.value_or(1), config_->access);
}

duration node::passage_of(const transport::to_network& x) const {
  return network::passage_up(x.segment.size(), config_->access);
}

void node::carry(communication::channel_packet x, bool in_slot, node_outputs& out, instant now) {
  const acting_on its(x.from);
  const auto how = in_slot ? network::departure::in_slot : network::departure::in_turn;
  send_on(x.channel, std::move(x.octets), how, out, now);
}

void node::carry(transport::to_network x, bool in_slot, node_outputs& out, instant now) {
  const acting_on its(x.from);
  route(x, in_slot, out, now);
}

/// One at each turn, in order: who reads a stream drops what newer records have overtaken. Turns
/// may come a little less often than packets: then two go one after the other.
void node::send_paced(node_outputs& out, instant now) {
  for (auto x = paced_.begin(); x != paced_.end();) {
    auto& [channel, waiting] = *x;
    if (waiting.due > now) {
      ++x;
      continue;
    }
    const auto count = waiting.packets.size() > paced_usual ? 2 : 1;
    for (int i = 0; i < count; ++i) {
      auto& [octets, from] = waiting.packets.front();
      const acting_on its(from);
      send_on(channel, std::move(octets), network::departure::at_once, out, now);
      waiting.packets.erase(waiting.packets.begin());
    }
    if (waiting.packets.empty()) {
      x = paced_.erase(x);
      continue;
    }
    const auto next = duty_.next_turn(channel_of(channel), now + 1ms, packets_.router().clock());
    waiting.due = next.value_or(now); // there are no turns any more: all may go
    x = next ? std::next(x) : x;
  }
}

void node::send_on(stream::channel_handle channel, bytes octets, network::departure how,
                   node_outputs& out, instant now) {
  auto sent = packets_.router().send_on(channel_of(channel), std::move(octets), how, now);
  if (sent) {
    take(*std::move(sent), out, now);
  } else {
    ++counters_.channel_full;
    note_loss(loss::channel_full);
  }
}

/// What is to come back takes longer the longer frames wait for their turn at each hop.
void node::heed_waits(instant now) {
  const auto& router = packets_.router();
  const bool waits = config_->duty.enabled && router.turn_wait(now) > 0s;
  const auto hops = router.tree().hops();
  const auto slack =
      (waits ? config_->duty.answer_slack(hops) : 0ns) + config_->access.answer_slack(hops);
  if (std::exchange(slack_, slack) != slack)
    use_layer().set_answer_slack(slack);
}

/// To a mote of the own island, or through the sink (RTG-04).
void node::route(transport::to_network& x, bool in_slot, node_outputs& out, instant now) {
  const bool is_local = x.destination.island == island_ && x.destination.mote != no_mote;
  const network::island_packet packet{x.destination.island, x.destination.mote, x.channel,
                                      std::move(x.segment)};
  if (is_local && packet.mote == config_->id) {
    on_packet(packet, now);
    return;
  }
  if (is_local && packet.mote == broadcast_mote) {
    take(packets_.send_to_all(packet, now), out, now);
    return;
  }
  const auto sink = packets_.router().tree().root();
  if (!is_local || packet.mote == sink)
    join_.on_sent(now);
  take(packets_.send(is_local ? packet.mote : sink, packet, now, in_slot), out, now);
}

void node::connect(const communication::channel_wanted& x, node_outputs& out, instant now) {
  auto& router = packets_.router();
  network::channel_schedule schedule;
  schedule.interval = x.interval;
  schedule.size = static_cast<std::uint8_t>(std::min(x.size, network::channel_packet_max));
  if (router.clock().synchronised())
    schedule.first =
        beside_the_window(router.clock().at(now + x.interval), x.interval, config_->duty, rng_);
  const auto expiry = std::max<duration>(expiry_min, expiry_intervals * x.interval);
  auto [id, todo] = router.connect(x.destination, schedule, expiry, now);
  connecting_[id] = x.request;
  take(std::move(todo), out, now);
}

// Transducers and actuators.

std::optional<std::int16_t> node::read(device::quantity kind, instant now) {
  if (kind == device::quantity::signal)
    return parent_dbm_;
  const auto found =
      std::ranges::find(config_->transducers, kind, &device::transducer_config::kind);
  if (found == config_->transducers.end())
    return std::nullopt;
  return sample(*found, now, rng_, {place_, config_->transducer_seed});
}

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
  use_layer().devices().on_sample(x.stream,
                                  {{island_, config_->id}, time_ms(now), count.value_or(0)}, now);
}

void node::carry_out(const communication::transducers_wanted& x, instant now) {
  std::vector<std::int16_t> counts;
  for (const auto kind : x.kinds)
    counts.push_back(read(kind, crystal_.real(now)).value_or(0));
  use_layer().devices().on_transducers(x.process, std::move(counts), time_ms(now), now);
}

void node::carry_out(const communication::actuator_wanted& x, node_outputs& out, instant now) {
  const auto found = actuators_.find(x.name);
  const bool obeyed = found != actuators_.end() && found->second.set(x.state, now);
  const auto state = actuator_state(x.name, now).value_or(0);
  if (obeyed && state == x.state)
    out.emplace_back(actuator_arrived{x.name, state});
  use_layer().devices().on_actuator(x.process, x.name, state, obeyed, now);
}

std::optional<std::uint8_t> node::actuator_state(const std::string& name, instant now) const {
  const auto found = actuators_.find(name);
  if (found == actuators_.end())
    return std::nullopt;
  return found->second.state(now);
}

std::size_t node::footprint() const {
  constexpr std::size_t join_octets = 32;
  constexpr std::size_t clock_octets = 12;
  return packets_.footprint() + layer_->footprint() + join_octets + clock_octets +
         duty_cycle::footprint(config_->tables->network.paths.entries_max);
}

} // namespace rubicon::mote
