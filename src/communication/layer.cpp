#include "communication/layer.hpp"

#include <utility>

#include "communication/layer_totals.hpp"
#include "core/account/message_ledger.hpp"

namespace rubicon::communication {

layer::~layer() = default;

layer::layer(const layer_config& config, random_stream rng) : ports_(config, rng) {}

interface layer::attach(communication_events& events, std::string name) {
  return interface(processes_[add_program(events, std::move(name))]->commands);
}

interface layer::attach_for_rest(communication_events& events) {
  const auto program = add_program(events, {});
  ports_.messages.provide_rest(program);
  return interface(processes_[program]->commands);
}

std::size_t layer::add_program(communication_events& events, std::string name) {
  const auto program = ports_.programs.attach(events, std::move(name));
  if (program == processes_.size())
    processes_.push_back(std::make_unique<direct_process>(direct_program{ports_, program}));
  ports_.messages.attach(program);
  return program;
}

layer_outputs layer::take_outputs() {
  ports_.programs.dispatch();
  return std::exchange(ports_.node.outputs, {});
}

// Membership.

void layer::on_initialised(bool success, instant now) {
  set_time(now);
  ports_.node.initialised = success;
  ports_.programs.notify_all([success](auto& x) { x.initCommunicationsDone(status_of(success)); });
}

void layer::on_joined(island_id island, instant now) {
  set_time(now);
  ports_.node.island = island;
  ports_.messages.on_joined(island);
  ports_.channels.on_joined(island);
  const auto at = ports_.node.address();
  ports_.programs.notify_all(
      [at](auto& x) { x.joined(octet_of(at.island), at.mote.value, SUCCESS); });
}

void layer::on_left(instant now) {
  set_time(now);
  const auto at = ports_.node.address();
  ports_.node.island.reset();
  ports_.messages.on_left();
  ports_.programs.notify_all([at](auto& x) { x.joined(octet_of(at.island), at.mote.value, FAIL); });
}

void layer::on_mote_joined(mote_id mote, byte_view description, instant now) {
  set_time(now);
  ports_.programs.notify_all(
      [mote, octets = to_bytes(description)](auto& x) { x.moteJoined(mote.value, octets); });
}

void layer::on_packet(island_id source, std::uint16_t channel, byte_view body, instant now) {
  set_time(now);
  if (channel <= 0xff) {
    ports_.messages.on_segment(source, body);
  } else if (channel == transport::tunnel_channel) {
    ports_.channels.on_tunnel_packet(source, body);
  } else {
    ++ports_.node.counters.unknown_channel;
    note_loss(loss::no_program);
  }
}

void layer::set_answer_slack(duration x) {
  ports_.messages.set_answer_slack(x);
  ports_.streams.set_answer_slack(x);
  ports_.synaptic.set_answer_slack(x);
}

// Time.

void layer::on_time(instant now) {
  set_time(now);
  ports_.messages.on_time();
  ports_.channels.on_time();
  ports_.streams.on_time();
  ports_.synaptic.on_time();
}

std::optional<instant> layer::deadline() const {
  return earliest(earliest(ports_.messages.deadline(), ports_.channels.deadline()),
                  earliest(ports_.streams.deadline(), ports_.synaptic.deadline()));
}

std::size_t layer::footprint() const {
  return ports_.messages.footprint() + ports_.channels.footprint() +
         ports_.streams.core().footprint() + ports_.synaptic.core().footprint();
}

layer_totals totals_of(const layer& x) {
  const auto& ports = x.ports();
  return {x.counters(), ports.streams.core().counters(), ports.synaptic.core().counters(),
          x.ports().messages.core().counters(), ports.channels.tunnels().counters()};
}

} // namespace rubicon::communication
