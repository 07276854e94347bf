// What a gateway receives from its sink.
#include <algorithm>
#include <utility>

#include "core/account/message_ledger.hpp"
#include "gateway/gateway.hpp"
#include "gateway/tuples.hpp"
#include "network/am.hpp"
#include "transport/segment.hpp"

namespace rubicon::gateway {

namespace {

/// Whether a message between islands asks for reliable transfer: its segment says so. An
/// acknowledgement goes unreliably, since a lost one is asked for again end to end.
bool wants_reliable(byte_view segment) {
  const auto decoded = transport::decode_segment(segment);
  return decoded && decoded->what == transport::segment::kind::reliable;
}

} // namespace

void gateway::on_line_input(const occasion& at) {
  if (sink_.on_packet(at))
    pc_.term().set_line(true);
}

/// A packet of the sink, or what it might have said.
void gateway::dispatch(mote_id source, std::uint8_t am_type, byte_view payload,
                       const occasion& at) {
  const bool is_packet = am_type == network::am::to_gateway || am_type == network::am::packet;
  if (is_packet && !lead_.leads()) { // its sender will repeat it to who does
    ++counters_.undeliverable;
    note_loss(loss::not_leading);
  } else if (am_type == network::am::to_gateway) {
    on_island_packet(payload, at);
  } else if (am_type == network::am::packet) {
    if (const auto whole = sink_.on_fragment(source, payload, at.now))
      on_island_packet(*whole, at);
  } else if (am_type != network::am::sink_event) {
    ++counters_.unknown_type;
  } else if (const auto event = network::decode_sink_event(payload)) {
    if (!at.of_plain)
      sink_.note_own_sink();
    std::visit([this, &at](const auto& x) { on_event(x, at); }, *event);
  } else {
    ++counters_.malformed;
  }
}

void gateway::on_island_packet(byte_view payload, const occasion& at) {
  auto packet = network::decode_island_packet(payload);
  if (!packet) {
    ++counters_.malformed;
    note_loss(loss::malformed);
    return;
  }
  const bool here = is_here(packet->island);
  if (here && packet->mote == no_mote) {
    on_packet_for_us(*packet, at);
  } else if (here) { // a sink sends these on itself; one of another make may not
    packet->island = config_.island;
    send(*packet, at);
  } else {
    ++counters_.forwarded_out;
    const bool reliable = wants_reliable(packet->body);
    others_.send(packet->island, {packet->mote, packet->channel, std::move(packet->body)}, reliable,
                 at);
  }
}

bool gateway::is_here(island_id x) const {
  return x == config_.island || x == own_island ||
         std::ranges::find(config_.gateways, gateway_of(x)) != config_.gateways.end();
}

void gateway::on_packet_for_us(const network::island_packet& x, const occasion& at) {
  const auto decoded = transport::decode_segment(x.body);
  if (x.channel <= 0xff && decoded && !motes_.is_listed(decoded->source)) {
    // Its join was lost on the serial line. Unacknowledged, a reliable message will come again.
    ++counters_.undeliverable;
    note_loss(loss::not_listed);
    at.out.emplace_back(ask_about(decoded->source));
    return;
  }
  take(pc_.term().on_packet(config_.island, x.channel, x.body, at.now), at);
}

void gateway::on_event(const network::mote_joined& x, const occasion& at) {
  const auto how = motes_.on_joined(x, at);
  if (!how)
    return;
  if (how->restarted)
    pc_.term().forget_incarnation({config_.island, x.mote});
  if (!at.of_plain)
    requests_.on_listed(x.mote, x.incarnation, at.now);
  if (how->is_new || how->restarted)
    take(pc_.term().on_mote_joined(x.mote, x.descriptor, at.now), at);
  if (how->contradicts)
    at.out.emplace_back(ask_about(x.mote));
}

void gateway::on_event(const network::mote_left& x, const occasion& at) {
  if (motes_.on_left(x, at))
    requests_.on_unlisted(x.mote);
}

void gateway::on_event(const network::roster& x, const occasion& at) {
  motes_.on_roster(x, at);
}

void gateway::on_event(const network::describe&, const occasion&) {
  ++counters_.unknown_type; // a question only gateways ask
}

void gateway::on_event(const network::sink_started&, const occasion& at) {
  motes_.on_sink_started(at);
}

void gateway::on_event(const network::time_request& x, const occasion& at) {
  if (const auto answer = pc_.answer_to(x, at.now))
    at.out.emplace_back(answer_sink{*answer});
}

void gateway::on_event(const network::gateway_poll& x, const occasion& at) {
  if (lead_.alone()) {
    ++counters_.unknown_type;
    return;
  }
  const auto change = lead_.on_poll(x, at.now);
  at.out.emplace_back(answer_sink{lead_.answer()});
  change_lead(change, at);
}

void gateway::on_event(const network::gateway_answer&, const occasion&) {
  ++counters_.unknown_type;
}

void gateway::on_event(const network::time_answer&, const occasion&) {
  ++counters_.unknown_type; // only gateways answer
}

} // namespace rubicon::gateway
