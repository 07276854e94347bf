#include "mote/sink.hpp"

#include <algorithm>
#include <utility>

#include "core/account/message_ledger.hpp"
#include "core/overloads.hpp"
#include "network/am.hpp"
#include "network/clock/tick_plan.hpp"
#include "network/wire.hpp"

namespace rubicon::mote {

namespace {

void append(sink_outputs& to, sink_outputs from) {
  std::ranges::move(from, std::back_inserter(to));
}

} // namespace

sink::sink(network::router_config network, registrar_config members, const duty_config& duty,
           random_stream rng, instant now, gateway_lines_config lines, const nonvolatile& store)
    : self_(network.self), store_(begin_life(store)), island_(members.island), duty_(duty, true),
      lines_(lines, now, store.term), fragments_(lines.lines) {
  network.is_sink = true;
  network.era = store.era;
  network.duty = duty.common();
  members.confirm_wait += duty.answer_slack(0) + 2 * network.wake;
  registrar_ = registrar(members);
  packets_ = packet_service(network, rng, now);
  network::time_reference_config timing;
  timing.gap *= lines.slowness;
  timing.gap_first *= lines.slowness;
  timing.answer_max *= lines.slowness;
  time_ = network::time_reference(timing, now);
}

sink_outputs sink::start(instant now) {
  store_.term = lines_.term();
  sink_outputs out{store_nonvolatile{store_}, event_for(network::sink_started{})};
  append(out, take(registrar_.start(now), now));
  return finish(std::move(out), now);
}

sink_outputs sink::on_frame(mote_id source, std::uint8_t am_type, byte_view payload, instant sfd,
                            instant now, network::medium over) {
  return finish(take(packets_.on_frame(source, am_type, payload, sfd, now, over), now), now);
}

sink_outputs sink::on_sent(std::uint64_t token, bool acked, unsigned transmissions, instant now) {
  duty_.on_sent(token);
  return finish(take(packets_.on_sent(token, acked, transmissions, now), now), now);
}

sink_outputs sink::on_packet(std::uint8_t am_type, byte_view payload, instant now,
                             std::size_t line) {
  auto whole = am_type == network::am::packet ? fragments_.at(line).on_fragment(self_, payload, now)
                                              : std::optional(to_bytes(payload));
  if (!whole)
    return {};
  if (am_type == network::am::from_gateway || am_type == network::am::packet) {
    const auto packet = network::decode_island_packet(*whole);
    if (!packet) {
      ++counters_.malformed;
      note_loss(loss::malformed);
      return {};
    }
    ++counters_.down;
    return finish(to_island(*packet, now), now);
  }
  if (am_type == network::am::sink_event) {
    if (const auto event = network::decode_sink_event(*whole))
      return on_event(*event, now, line);
    ++counters_.malformed;
    return {};
  }
  ++counters_.unknown_type;
  return {};
}

sink_outputs sink::on_event(const network::sink_event& x, instant now, std::size_t line) {
  if (const auto* wanted = std::get_if<network::describe>(&x))
    return finish(take(registrar_.on_describe(wanted->mote, now), now), now);
  if (const auto* answer = std::get_if<network::time_answer>(&x)) {
    time_.on_answer(answer->number, answer->since_1970, now, answer->held);
    tell_time(now);
    return finish({}, now);
  }
  if (const auto* answer = std::get_if<network::gateway_answer>(&x)) {
    lines_.on_answer(line, *answer, now);
    return finish(remember(), now);
  }
  ++counters_.malformed;
  return {};
}

/// A term or an era that others know of must never begin again.
sink_outputs sink::remember() {
  const auto before = store_;
  store_.term = lines_.term();
  store_.era = packets_.router().sync().era();
  if (store_ == before)
    return {};
  return {store_nonvolatile{store_}};
}

void sink::on_clock_leapt(duration by) {
  packets_.router().sync().on_clock_leapt(in_us(by));
  time_.on_clock_leapt(in_us(by));
}

to_gateway sink::event_for(const network::sink_event& x) const {
  return {self_, network::am::sink_event, encode(x)};
}

/// Its answer is of no use when it is late.
to_gateway sink::question(const network::sink_event& x, std::size_t line) const {
  auto out = event_for(x);
  out.line = line;
  out.urgent = true;
  return out;
}

/// The island's clock shows the time that the gateway has sent (CLK-08).
void sink::tell_time(instant now) {
  if (const auto time = time_.at(now))
    packets_.router().sync().set_network_time(*time, time_.drift().value_or(0), now);
}

sink_outputs sink::on_time(instant now) {
  tell_time(now);
  auto out = take(registrar_.on_time(now), now);
  const auto polls = lines_.on_time(now);
  auto from_packets = take(packets_.on_time(now), now);
  append(out, remember());
  for (const auto& x : polls)
    out.emplace_back(question(x.what, x.line));
  if (const auto number = time_.on_time(now)) {
    auto asks = question(network::time_request{*number}, lines_.leader());
    asks.asks_time = true;
    out.emplace_back(std::move(asks));
  }
  append(out, std::move(from_packets));
  return finish(std::move(out), now);
}

instant sink::deadline() const {
  const auto due = earliest(registrar_.deadline(), earliest(duty_.deadline(), lines_.deadline()));
  return std::min(*earliest(packets_.deadline(), due), time_.deadline());
}

/// Lets the frames go that may.
sink_outputs sink::finish(sink_outputs out, instant now) {
  auto& router = packets_.router();
  if (const auto tick = router.clock().tick(now))
    registrar_.set_slot_room(network::tick_plan(tick->period).units());
  router.use_slots(registrar_.slots().used(), now);
  for (auto& x : duty_.update(now, router.clock(), router.search())) {
    if (auto* frame = std::get_if<network::frame_out>(&x))
      out.emplace_back(std::move(*frame));
  }
  return out;
}

sink_outputs sink::take(packet_service_outputs from_packets, instant now) {
  sink_outputs out;
  const overloads act{
      [&](network::frame_out& x) { duty_.submit(std::move(x)); },
      [&](const management_in& x) {
        const auto route = packets_.router().packets().routes().route_to(x.origin);
        const auto hops = route ? route->size() : 0;
        append(out, take(registrar_.on_frame(x.origin, x.octets, now, hops), now));
      },
      [&](const packet_in& x) { append(out, from_island(x, now)); },
      [&](const network::channel_accepted& x) { // no app runs on a sink
        append(out, take(packets_.carry(packets_.router().refuse(x.channel, now), now), now));
      },
      // A sink keeps awake, is its island's clock and asks for no channels.
      [](const network::clock_corrected&) {},
      [](const network::channel_connected&) {},
      [](const network::channel_received&) {},
      [](const network::channel_ended&) {},
      [](const network::channel_reserved&) {},
  };
  for (auto& x : from_packets)
    std::visit(act, x);
  return out;
}

/// A packet says where it is to go, in which island; `own_island` is ours.
sink_outputs sink::from_island(const packet_in& x, instant now) {
  const auto origin = x.origin.value_or(self_);
  auto out = take(registrar_.on_received(origin, now), now);
  const auto& packet = x.packet;
  const bool is_local = packet.island == island_ || packet.island == own_island;
  if (!is_local || packet.mote == no_mote) {
    ++counters_.up;
    append(out, to_line(origin, packet));
  } else if (packet.mote == self_) {
    ++counters_.for_sink;
    note_loss(loss::no_program);
  } else if (!x.to_all) { // a flood reaches everybody without us
    ++counters_.turned;
    append(out, to_island({island_, packet.mote, packet.channel, packet.body}, now));
  }
  return out;
}

sink_outputs sink::to_island(const network::island_packet& x, instant now) {
  return take(
      x.mote == broadcast_mote ? packets_.send_to_all(x, now) : packets_.send(x.mote, x, now), now);
}

sink_outputs sink::to_line(mote_id origin, const network::island_packet& x) {
  auto octets = encode(x);
  if (octets.size() <= network::frame_payload_max)
    return {to_gateway{origin, network::am::to_gateway, std::move(octets), lines_.leader()}};
  sink_outputs out;
  const auto fragments = transport::cut(octets, network::frame_payload_max, tag_++);
  for (const auto& fragment : *fragments) // packet_max octets never are too many
    out.emplace_back(to_gateway{origin, network::am::packet, fragment, lines_.leader()});
  return out;
}

sink_outputs sink::take(registrar_outputs from_registrar, instant now) {
  sink_outputs out;
  const overloads act{
      [&](const to_mote& x) {
        append(out, take(packets_.send_management(x.mote, encode(x.message), now), now));
      },
      [&](const double_refused& x) { out.emplace_back(x); },
      [&](const network::sink_event& x) { out.emplace_back(event_for(x)); },
  };
  for (const auto& x : from_registrar)
    std::visit(act, x);
  return out;
}

} // namespace rubicon::mote
