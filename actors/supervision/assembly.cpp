#include "actors/supervision/assembly.hpp"

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "actors/peis/peis_bluetooth.hpp"
#include "actors/peis/peis_lan.hpp"
#include "actors/supervision/bridge_assembly.hpp"
#include "actors/supervision/mote_assembly.hpp"
#include "actors/supervision/place_assembly.hpp"
#include "config/checks/slot_check.hpp"
#include "scheduler/coordinator.hpp"
#include "scheduler/messages/spawn.hpp"

namespace rubicon {

namespace {

/// All peers are known before the first kernel starts: its links name others.
void spawn_kernels(ecology_pointer self) {
  const auto& description = self->state.description;
  std::vector<std::string> names; // in the order of the description
  const auto add = [&](peer_id id, const std::string& name, std::optional<island_id> island,
                       std::size_t line = 0) {
    auto& peer = self->state.peers[name];
    peer.id = id;
    peer.name = name;
    peer.island = island;
    peer.line = line;
    peer.incarnation = self->state.process.starts;
    names.push_back(name);
  };
  for (const auto& island : description.islands) {
    if (!config::has_line(island.stack) || island.outside.has_gateway())
      continue;
    add(gateway_of(island.id), island.gateway_name, island.id);
    std::size_t line = 0;
    for (const auto& alias : island.aliases)
      add(alias.id, alias.name, island.id, ++line);
  }
  for (const auto& peer : description.peers) {
    add(peer.id, peer.name, {});
    self->state.peers.at(peer.name).component_of = peer.init;
  }
  for (const auto& name : names) {
    auto& peer = self->state.peers.at(name);
    if (!peer.component_of) // its init starts it
      spawn_kernel(self, peer, "peis_peer/" + name);
  }
}

/// The simulated network: it has nothing to report.
void spawn_lan(ecology_pointer self) {
  const auto& description = self->state.description;
  self->state.lan = scheduler::spawn_in<scheduler::monitored>(
      *self->state.pcs, self, "peis_lan", peis_lan, description.peis, description.seed);
  ++self->state.report.actors.spawned;
  self->state.names.emplace(self->state.lan.address(), "peis_lan");
}

/// Simulated Bluetooth, if any peer has it; it has nothing to report either.
void spawn_bluetooth(ecology_pointer self) {
  const auto& description = self->state.description;
  if (std::ranges::all_of(description.peers,
                          [](const auto& peer) { return peer.bluetooth.empty(); }))
    return;
  self->state.bluetooth = scheduler::spawn_in<scheduler::monitored>(
      *self->state.pcs, self, "peis_bluetooth", peis_bluetooth, description.peis,
      description.bluetooth_devices);
  ++self->state.report.actors.spawned;
  self->state.names.emplace(self->state.bluetooth.address(), "peis_bluetooth");
}

/// One window carries a frame over several hops, and few islands are deeper than eight.
transport::answer_slacks slacks_of(const config::ecology_description& x) {
  constexpr std::size_t hops_likely = 8;
  constexpr int rests = 5; ///< of the time in which a frame is repeated for a radio that listens
  std::map<island_id, transport::answer_slack> all;
  config::for_each_island(x, [&](const config::island_description& island) {
    const auto hops = std::min(island.motes.size(), hops_likely);
    const auto access = config::access_of(x.radio, island);
    const auto slack = island.duty.answer_slack(static_cast<unsigned>(hops)) +
                       access.answer_slack(static_cast<unsigned>(hops));
    if (slack > 0s)
      all[island.id] = {slack, std::max(island.duty.common().period, rests * access.wake)};
  });
  return all.empty() ? nullptr : std::make_shared<const decltype(all)>(std::move(all));
}

} // namespace

void note_starts(ecology_pointer self, std::uint32_t starts) {
  auto& state = self->state;
  if (starts <= state.most_starts)
    return;
  state.most_starts = starts;
  if (state.process.on_starts)
    state.process.on_starts(starts);
}

void assemble(ecology_pointer self) {
  const auto& description = self->state.description;
  self->state.slacks = slacks_of(description);
  self->state.pcs = &scheduler::coordinator::of(self->system())->add_process();
  for (const auto& island : description.islands)
    self->state.traffic[island.id] = traffic_in(self, island);
  spawn_lan(self);
  spawn_bluetooth(self);
  spawn_kernels(self);
  for (const auto& air : description.airs)
    spawn_place(self, air);
  for (const auto& island : description.islands)
    if (island.outside.has_sink())
      spawn_outside(self, island);
  for (const auto& peer : description.peers)
    if (!peer.init)
      spawn_programs(self, self->state.peers.at(peer.name));
}

} // namespace rubicon
