#include "actors/supervision/peer_supervision.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "actors/base/timer.hpp"
#include "actors/messages/common.hpp"
#include "actors/messages/links.hpp"
#include "actors/messages/peis.hpp"
#include "actors/messages/serial.hpp"
#include "actors/messages/services.hpp"
#include "actors/messages/supervision.hpp"

namespace rubicon {

namespace {

constexpr auto second = [](const auto& entry) -> const auto& {
  return entry.second;
};

void send_notable(ecology_pointer self, const supervised_peer& peer, std::string what) {
  self->send(self, notable_event{"peis_peer/" + peer.name, std::move(what)});
}

/// Ends an actor that we have spawned, without a word about it.
void end_quietly(ecology_pointer self, const caf::strong_actor_ptr& who) {
  auto& state = self->state;
  state.names.erase(who->address());
  std::erase_if(state.reporters, [&who](const auto& x) { return x.first == who->address(); });
  self->send_exit(who, caf::exit_reason::user_shutdown);
}

/// Whether the init of this component is notified how it fares: not of a second peer with its id.
bool is_watched(ecology_pointer self, const supervised_peer& peer) {
  return peer.component_of && &self->state.peers.at(peer.name) == &peer;
}

/// The peers that the init of this one has started.
std::vector<supervised_peer*> components_of(ecology_pointer self, const supervised_peer& peer) {
  std::vector<supervised_peer*> found;
  for (auto& [name, each] : self->state.peers) {
    if (each.component_of == peer.id && each.handle)
      found.push_back(&each);
  }
  return found;
}

/// The init of a component; nullptr if it does not run.
init_actor init_of(ecology_pointer self, const supervised_peer& component) {
  for (const auto& [name, each] : self->state.peers) {
    if (each.id == *component.component_of && each.handle)
      return each.init;
  }
  return {};
}

template <class Message>
void notify_init(ecology_pointer self, const supervised_peer& component) {
  if (const auto init = init_of(self, component))
    self->send(init, Message{component.name, component.life});
}

bool has_init(const supervised_peer& peer) {
  return peer.handle && peer.init;
}

void notify_when_inits_ended(ecology_pointer self) {
  const auto& state = self->state;
  if (std::ranges::none_of(state.peers, has_init, second) && state.process.on_inits_ended)
    state.process.on_inits_ended();
}

/// With an init ends all that it has started.
void end_init(ecology_pointer self, supervised_peer& peer);

/// Nobody is at the end of its line to real motes.
void leave_real_line(ecology_pointer self, const supervised_peer& gateway) {
  const auto& lines = self->state.real_lines;
  if (!gateway.island || gateway.programs.empty())
    return;
  if (const auto line = lines.find(*gateway.island); line != lines.end())
    self->send(line->second, watch_line{{}, true});
}

/// Ends a peer's process: kernel and programs.
void end_process(ecology_pointer self, supervised_peer& peer) {
  leave_real_line(self, peer);
  peer.managers.clear();
  for (const auto& program : std::exchange(peer.programs, {}))
    end_quietly(self, program);
  if (peer.handle)
    end_quietly(self, peer.handle.strong());
  peer.handle = nullptr;
  peer.changed = now(self);
  peer.away_since = now(self);
  if (is_watched(self, peer))
    notify_init<component_ended>(self, peer);
  if (peer.init)
    end_init(self, peer);
}

void end_init(ecology_pointer self, supervised_peer& peer) {
  auto& state = self->state;
  peer.init = nullptr;
  for (auto* component : components_of(self, peer))
    end_process(self, *component);
  if (state.ending)
    notify_when_inits_ended(self);
}

void restart_after(ecology_pointer self, const supervised_peer& peer,
                   std::optional<duration> length) {
  if (length && !peer.component_of) // a component is started again by its init
    self->delayed_send(self, *length, restart_peer{peer.name});
}

std::string lasting(std::optional<duration> length) {
  return length ? " for " + to_text(*length) : std::string();
}

/// A peer's computer loses its power or has it again.
void set_power(ecology_pointer self, std::uint64_t station, bool on) {
  self->send(self->state.lan, set_lan_power{station, on});
  if (self->state.bluetooth)
    self->send(self->state.bluetooth, set_lan_power{station, on});
}

void disturb(ecology_pointer self, begin_lan_fault x, duration length) {
  auto& state = self->state;
  x.fault = ++state.lan_faults;
  state.last_lan_fault = std::max(state.last_lan_fault, now(self) + length);
  self->delayed_send(state.lan, length, end_lan_fault{x.fault});
  self->send(state.lan, std::move(x));
}

} // namespace

supervised_peer* find_running(ecology_pointer self, peer_id id) {
  std::vector<supervised_peer*> peers;
  std::vector<supervised_peer*> gateways;
  for (auto& [name, peer] : self->state.peers) {
    if (peer.handle && (id == any_peer || peer.id == id))
      (peer.island && id == any_peer ? gateways : peers).push_back(&peer);
  }
  const auto& all = peers.empty() ? gateways : peers;
  if (all.empty())
    return nullptr;
  return all.size() == 1 ? all.front() : all[self->state.rng.below(all.size())];
}

void restart(ecology_pointer self, supervised_peer& peer) {
  if (peer.handle)
    return;
  if (!peer.powered)
    set_power(self, peer.station, true);
  const bool again = peer.begun;
  if (again) {
    ++peer.incarnation;
    ++self->state.report.actors.restarted;
  }
  spawn_kernel(self, peer, "peis_peer/" + peer.name);
  spawn_programs(self, peer);
  send_notable(self, peer,
               again ? "started again, life " + std::to_string(peer.incarnation + 1) : "started");
}

void start_component_peer(ecology_pointer self, const start_component& x) {
  auto& peer = self->state.peers.at(x.peer);
  peer.life = x.life;
  restart(self, peer);
  notify_init<component_started>(self, peer);
}

void stop_component_peer(ecology_pointer self, const stop_component& x) {
  auto& peer = self->state.peers.at(x.peer);
  if (!peer.handle)
    notify_init<component_ended>(self, peer);
  else if (x.at_once)
    end_process(self, peer);
  else
    self->send(peer.handle, quit_peer{});
}

void end_peers(ecology_pointer self) {
  auto& state = self->state;
  state.ending = true;
  for (const auto& [name, peer] : state.peers) {
    if (peer.handle && !peer.component_of)
      self->send(peer.handle, leave_network{});
  }
  notify_when_inits_ended(self);
}

void on_init_down(ecology_pointer self, const caf::actor_addr& init) {
  for (auto& [name, peer] : self->state.peers) {
    if (!peer.init || peer.init.address() != init)
      continue;
    end_init(self, peer);
    return;
  }
}

bool on_kernel_down(ecology_pointer self, const caf::actor_addr& kernel) {
  for (auto& [name, peer] : self->state.peers) {
    if (!peer.handle || peer.handle.address() != kernel)
      continue;
    std::erase_if(self->state.reporters, [&](const auto& x) { return x.first == kernel; });
    peer.handle = nullptr;
    end_process(self, peer);
    return true;
  }
  return false;
}

void end_duplicate_peer(ecology_pointer self, const std::string& name) {
  const auto found = self->state.duplicates.find(name);
  if (found == self->state.duplicates.end())
    return;
  end_process(self, found->second);
  self->state.duplicates.erase(found);
}

void peer_fault_applier::operator()(const config::kill_fault& x) const {
  auto* peer = find_running(self, x.peer);
  if (peer == nullptr)
    return;
  end_process(self, *peer);
  send_notable(self, *peer, "killed" + lasting(x.length));
  restart_after(self, *peer, x.length);
}

void peer_fault_applier::operator()(const config::power_off_fault& x) const {
  auto* peer = find_running(self, x.peer);
  if (peer == nullptr)
    return;
  auto dark = components_of(self, *peer); // they are on the same computer
  dark.push_back(peer);
  for (auto* each : dark) {
    each->powered = false;
    set_power(self, each->station, false); // before it is seen to end
  }
  end_process(self, *peer);
  send_notable(self, *peer, "power off" + lasting(x.length));
  restart_after(self, *peer, x.length);
}

void peer_fault_applier::operator()(const config::pause_fault& x) const {
  if (auto* peer = find_running(self, x.peer); peer != nullptr) {
    peer->changed = now(self) + x.length;
    self->send(peer->handle, pause_peer{x.length});
  }
}

void peer_fault_applier::operator()(const config::partition_fault& x) const {
  disturb(self, {0, x.groups, 0, {}}, x.length);
  self->send(self, notable_event{self->path(), "network in parts" + lasting(x.length)});
}

void peer_fault_applier::operator()(const config::link_loss_fault& x) const {
  disturb(self, {0, {}, x.loss, x.peers}, x.length);
  self->send(self, notable_event{self->path(), "network loses packages" + lasting(x.length)});
}

void peer_fault_applier::operator()(const config::duplicate_id_fault& x) const {
  auto& state = self->state;
  auto* peer = find_running(self, x.peer);
  if (peer == nullptr)
    return;
  auto copy = *peer;
  copy.programs = {};
  copy.managers = {};
  copy.init = nullptr;
  copy.incarnation = 0;
  const auto name = peer->name + "-double-" + std::to_string(state.stations + 1);
  auto& added = state.duplicates[name] = std::move(copy);
  spawn_kernel(self, added, "peis_peer/" + name);
  std::erase_if(state.reporters,
                [&](const auto& each) { return each.first == added.handle.address(); });
  peer->changed = now(self) + x.length.value_or(state.description.length);
  send_notable(self, *peer, "a second one with its id appears" + lasting(x.length));
  if (x.length)
    self->delayed_send(self, *x.length, end_duplicate{name});
}

void peer_fault_applier::operator()(const config::clock_step_fault& x) const {
  auto* peer = find_running(self, x.peer);
  if (peer == nullptr)
    return;
  self->send(peer->handle, step_clock{x.by});
  send_notable(self, *peer,
               "clock set " + std::string(x.by < 0s ? "back by " : "forward by ") +
                   to_text(x.by < 0s ? -x.by : x.by));
}

void peer_fault_applier::operator()(const config::move_fault& x) const {
  auto& state = self->state;
  auto* peer = find_running(self, x.peer);
  if (peer == nullptr)
    return;
  state.last_lan_fault = std::max(state.last_lan_fault, now(self));
  if (state.bluetooth)
    self->send(state.bluetooth, move_machine{peer->machine, x.to});
  send_notable(self, *peer,
               "carried to " + std::to_string(std::lround(x.to.x_m)) + ", " +
                   std::to_string(std::lround(x.to.y_m)));
}

} // namespace rubicon
