#include "actors/island/mote_report.hpp"

#include <utility>

#include "actors/base/statuses.hpp"
#include "actors/island/mote_firmware.hpp"
#include "actors/messages/supervision.hpp"
#include "communication/program_port.hpp"

namespace rubicon {

void mote_report::send(life_state life) const {
  const auto& state = self_->state;
  const auto& arguments = *state.arguments;
  const bool is_alive = life == life_state::goes_on;
  state.flows.report(self_, arguments.ecology);
  if (state.plain)
    send_modules(self_, arguments.ecology, arguments.name, state.plain->counted());
  if (state.firmware)
    send_modules(self_, arguments.ecology, arguments.name, mote_firmware(self_).counted());
  if (state.groups)
    self_->send(arguments.ecology, status_of(arguments.address.island, state.groups->node, life));
  if (!state.node)
    return;
  send_messages(is_alive);
  send_network(is_alive);
  state.programs.report(self_, arguments.ecology, arguments.name, mote_shell{self_}.own_time(),
                        !is_alive);
}

void mote_report::send_messages(bool is_alive) const {
  const auto& state = self_->state;
  auto status = messages_of(state.arguments->address, state.node->above(), !is_alive);
  status.messages.refused["off"] = 0; // its programs stop with it
  self_->send(state.arguments->ecology, std::move(status));
}

/// The clock of a life that has ended is compared with nothing, and its place in the tree is free.
void mote_report::send_network(bool is_alive) const {
  auto& state = self_->state;
  const auto& arguments = *state.arguments;
  auto status = status_of(arguments.address, *state.node, mote_shell{self_}.own_time(), now(self_));
  if (!is_alive) {
    status.has_clock = false;
    status.network.synchronised = 0;
    status.network.aligned = 0;
    status.network.hops_max = 0;
    status.parent = {};
    status.channels.clear();
  } else if (const auto dbm = state.node->read(device::quantity::signal, now(self_))) {
    status.has_signal = *dbm != mote::mote_devices::signal_unknown;
    status.signal_dbm = *dbm;
  }
  report::add_counters<communication::program_port_counters>(status.network.counters, "programs",
                                                             state.separate.counters());
  self_->send(arguments.ecology, std::move(status));
}

void mote_report::send_sample(std::uint64_t number) const {
  const auto& state = self_->state;
  if (!state.node || state.flat)
    return;
  const auto& arguments = *state.arguments;
  auto x = sample_of(
      number, status_of(arguments.address, *state.node, mote_shell{self_}.own_time(), now(self_)));
  x.who = arguments.name;
  x.missed = state.programs.vectors_missed();
  self_->send(arguments.ecology, std::move(x));
}

} // namespace rubicon
