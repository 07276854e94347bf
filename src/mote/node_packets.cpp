// mote::node: what its layer requests, above all packets of programs and channels that carry them.
#include "mote/node.hpp"

#include <algorithm>
#include <utility>

#include "core/account/message_ledger.hpp"
#include "core/overloads.hpp"
#include "mote/stack/channel_handle.hpp"
#include "network/island_packet.hpp"

namespace rubicon::mote {

namespace {

constexpr duration expiry_min = 5min; ///< of a channel without packets,
constexpr int expiry_intervals = 10;  ///< or so many of its intervals

/// What a scheduled packet takes from end to end: ten hops, and some more.
constexpr duration route_max = 10 * network::channel_slot;

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
                 [&](const communication::init_wanted&) { layer_.use().on_initialised(true, now); },
                 [&](const communication::join_wanted& y) { ask_to_join(y.description, out, now); },
             },
             x);
}

/// Where radios sleep, packets of channels with a schedule wait for their turns.
void node::pace(communication::channel_packet x, node_outputs& out, instant now) {
  const auto turn = duty_.next_turn(channel_of(x.channel), now, packets_.router().clock());
  if (!turn)
    carry_in_slot(std::move(x), out, now);
  else if (pacer_.push(x.channel, *turn, std::move(x.octets), std::move(x.from)))
    ++counters_.paced_out;
}

/// Packets of vectors leave one after the other in our slot, if it has room for them; others at
/// once, which means in their turn.
template <class Packet>
void node::carry_in_slot(Packet x, node_outputs& out, instant now) {
  const auto begin =
      x.in_slot ? slot_.take(passage_of(x), config_->access.space, now) : std::nullopt;
  if (begin && *begin > now)
    slot_.delay(*begin, std::move(x));
  else
    carry(std::move(x), begin.has_value(), out, now);
}

void node::send_slotted(node_outputs& out, instant now) {
  for (auto next = slot_.next(now); next; next = slot_.next(now))
    std::visit([&](auto& x) { carry(std::move(x), true, out, now); }, *next);
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

void node::send_paced(node_outputs& out, instant now) {
  pacer_.send_due(
      now,
      [&](stream::channel_handle channel, bytes octets) {
        send_on(channel, std::move(octets), network::departure::at_once, out, now);
      },
      [&](stream::channel_handle channel) {
        return duty_.next_turn(channel_of(channel), now + 1ms, packets_.router().clock());
      });
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
void node::update_slack(instant now) {
  const auto& router = packets_.router();
  const bool waits = config_->duty.enabled && router.turn_wait(now) > 0s;
  const auto hops = router.tree().hops();
  const auto slack =
      (waits ? config_->duty.answer_slack(hops) : 0ns) + config_->access.answer_slack(hops);
  if (std::exchange(slack_, slack) != slack)
    layer_.use().set_answer_slack(slack);
}

/// To a mote of the own island, or through the sink (RTG-04).
void node::route(transport::to_network& x, bool in_slot, node_outputs& out, instant now) {
  const bool is_local = x.destination.island == member_.island() && x.destination.mote != no_mote;
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
    member_.client().on_sent(now);
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

void node::set_latency_bound(network::channel_id channel) {
  if (const auto bound = packets_.router().paths().latency_bound(channel))
    layer_.use().channels().set_latency_bound(handle_of(channel), *bound);
}

} // namespace rubicon::mote
