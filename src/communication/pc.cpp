#include "communication/pc.hpp"

#include <algorithm>
#include <ranges>

#include "core/account/message_ledger.hpp"
#include "core/overloads.hpp"
#include "network/island_packet.hpp"

namespace rubicon::communication {

namespace {

island_id island_of(peer_id x) {
  return island_id(static_cast<std::uint32_t>(x.value));
}

layer_config layer_of(const pc_config& config) {
  layer_config x;
  x.self = no_mote;
  x.incarnation = config.incarnation;
  x.messages.ack_wait = config.ack_wait;
  x.messages.outstanding_max = config.sends_max;
  x.messages.slacks = config.slacks;
  x.messages.sessions_max = 1024;
  x.messages.sources_max = 1024;
  x.tunnels.tunnels_max = 4 * config.channels_max;
  x.streams.streams_max = config.channels_max;
  x.streams.early_max = config.channels_max;
  x.synaptic.channels_max = config.channels_max;
  x.synaptic.early_max = config.channels_max;
  x.synaptic.size_max = config.vector_max;
  x.synaptic.tick_period = config.tick_period;
  x.unclaimed_max = config.channels_max;
  return x;
}

} // namespace

peer_message message_of(transport::to_network x) {
  const auto [island, mote] = x.destination;
  return {gateway_of(island),
          encode(network::gateway_packet{mote, x.channel, std::move(x.segment)})};
}

pc::pc(pc_config config, random_stream rng)
    : config_(config), layer_(std::make_unique<layer>(layer_of(config), rng)) {
  if (!config_.awaits_clock)
    ahead_ = 0s;
}

interface pc::attach(communication_events& events) {
  has_programs_ = true;
  return layer_->attach(events);
}

void pc::observe(std::function<void(const program_note&)> observer) {
  layer_->observe(std::move(observer));
}

outputs pc::start(instant now) {
  now_ = now;
  layer_->on_initialised(true, now);
  layer_->on_joined(island_of(config_.self), now);
  tick(now);
  return flush();
}

outputs pc::on_message(peer_id source, byte_view octets, instant now) {
  now_ = now;
  const auto packet = network::decode_gateway_packet(octets);
  if (!packet || source.value <= 0) {
    ++counters_.malformed;
    note_loss(loss::malformed);
  } else if (packet->mote != no_mote) {
    ++counters_.misdirected;
    note_loss(loss::no_program);
  } else {
    layer_->on_packet(island_of(source), packet->channel, packet->body, now);
  }
  return flush();
}

outputs pc::on_packet(island_id source, std::uint16_t channel, byte_view body, instant now) {
  now_ = now;
  layer_->on_packet(source, channel, body, now);
  return flush();
}

outputs pc::on_mote_joined(mote_id mote, byte_view description, instant now) {
  now_ = now;
  layer_->on_mote_joined(mote, description, now);
  return flush();
}

outputs pc::on_clock(duration ahead, instant now) {
  now_ = now;
  ahead_ = ahead;
  layer_->set_network_ahead(ahead);
  tick(now);
  return flush();
}

outputs pc::on_time(instant now) {
  now_ = now;
  tick(now);
  layer_->on_time(now);
  return flush();
}

std::optional<instant> pc::deadline() const {
  return earliest(clock_.deadline(), layer_->deadline());
}

void pc::tick(instant now) {
  if (!has_programs_ || !ahead_)
    return;
  const auto since = std::chrono::floor<island_clock::duration>(now.time_since_epoch() + *ahead_);
  if (const auto next = clock_.update(now, island_time(since), {0, {}, config_.tick_period}))
    layer_->vectors().on_tick(next->number, now);
}

outputs pc::flush() {
  outputs out;
  for (auto wanted = layer_->take_outputs(); !wanted.empty(); wanted = layer_->take_outputs()) {
    for (auto& x : wanted)
      perform(x, out);
  }
  return out;
}

void pc::perform(layer_output& x, outputs& out) {
  std::visit(
      overloads{
          [&](transport::to_network& y) {
            const auto to = y.destination;
            if (to == mote_address{island_of(config_.self), no_mote})
              layer_->on_packet(to.island, y.channel, y.segment, now_);
            else
              out.push_back(std::move(y));
          },
          [&](const sample_wanted& y) {
            ++counters_.no_transducer; // open_sensor() refuses: a PC has none
            layer_->devices().on_sample(y.stream, {}, now_);
          },
          [&](const channel_wanted& y) { // a PC is in no island
            layer_->channels().on_connect_failed(y.request, now_);
          },
          [&](const init_wanted&) { layer_->on_initialised(line_up_, now_); },
          [&](const join_wanted&) { layer_->on_joined(island_of(config_.self), now_); },
          // Without a channel there is no packet on one; calls that want what a PC has not fail.
          [](const channel_packet&) {},
          [](const channel_unwanted&) {},
          [](const transducers_wanted&) {},
          [](const actuator_wanted&) {},
      },
      x);
}

} // namespace rubicon::communication
