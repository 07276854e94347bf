#include "actors/assembly.hpp"

#include <algorithm>
#include <set>

#include "actors/air.hpp"
#include "actors/apps/peer_apps.hpp"
#include "actors/gateway.hpp"
#include "actors/peis_peer.hpp"
#include "actors/proxy_manager.hpp"
#include "actors/serial_line.hpp"
#include "actors/sink.hpp"
#include "scheduler/spawn.hpp"

namespace rubicon {

namespace {

/// Sinks are fed by their basestation's USB port.
constexpr double mains_mah = 1e9;

/// Spawns a monitored child that reports to the ecology.
template <class Fun, class... Args>
auto spawn_child(ecology_pointer self, std::string path, Fun fun, Args&&... args) {
  auto handle = scheduler::spawn_at<caf::monitored>(self, path, fun, std::forward<Args>(args)...);
  ++self->state.report.actors.spawned;
  self->state.names.emplace(handle.address(), std::move(path));
  self->state.reporters.emplace_back([self, handle](status_request x) { self->send(handle, x); });
  return handle;
}

ecology_actor handle_of(ecology_pointer self) {
  return caf::actor_cast<ecology_actor>(self);
}

/// @pre the description has an island with this id
const config::island_description& described(ecology_pointer self, island_id id) {
  return *std::ranges::find(self->state.description.islands, id, &config::island_description::id);
}

std::string type_name(const config::mote_description& x) {
  return x.type_name.empty() ? std::to_string(x.type) : x.type_name;
}

/// A mote promises to be heard somewhat more rarely than it reports, so that a report on time makes
/// a keep-alive unnecessary.
duration keep_alive_of(const config::island_description& island,
                       const config::mote_description& mote) {
  auto period = island.keep_alive * 3 / 10;
  for (const auto& app : mote.apps) {
    if (const auto* sampler = std::get_if<config::sampler_app>(&app))
      period = std::max(period, sampler->every * 3 / 2);
  }
  return period;
}

mote_arguments arguments_of(ecology_pointer self, const config::island_description& island,
                            const config::mote_description& mote, radio::radio_index radio,
                            const air_actor& air) {
  mote_arguments x;
  x.address = {island.id, mote.id};
  x.name = island.name + '/' + mote.name;
  x.node.id = mote.id;
  x.node.type = mote.type;
  x.node.keep_alive = keep_alive_of(island, mote);
  x.stack = island.stack;
  x.path = mote.path;
  x.step = mote.step;
  x.node.transducers = mote.transducers;
  x.node.actuators = mote.actuators;
  x.apps = mote.apps;
  x.seed = self->state.description.seed;
  x.radio = radio;
  x.air = air;
  x.ecology = handle_of(self);
  return x;
}

/// The serial line, sink, gateway and gateway's kernel of an island.
void spawn_bridge(ecology_pointer self, const config::island_description& island,
                  radio::radio_index radio, const air_actor& air) {
  const auto seed = self->state.description.seed;
  const auto ecology = handle_of(self);
  const auto line_path = "serial_line/" + island.name;
  const auto line =
      spawn_child(self, line_path, serial_line,
                  serial::line(island.serial, random_stream(seed, line_path)), island.id, ecology);
  self->state.lines[island.id] = line;

  mote::registrar_config registrar;
  registrar.island = island.id;
  registrar.keep_alive_window = island.keep_alive;
  serial::mote_port_config port;
  port.baud = island.serial.baud;
  sink_arguments at_sink;
  at_sink.address = {island.id, island.sink.id};
  at_sink.registrar = registrar;
  at_sink.port = port;
  at_sink.radio = radio;
  at_sink.air = air;
  at_sink.line = line;
  at_sink.apps = island.sink.apps;
  at_sink.seed = seed;
  at_sink.ecology = ecology;
  spawn_child(self, "sink/" + island.name, sink, std::move(at_sink));

  gateway_arguments gateway;
  gateway.config.island = island.id;
  gateway.seed = seed;
  gateway.peer = self->state.peers.at(island.gateway_name).second;
  gateway.line = line;
  gateway.ecology = ecology;
  spawn_child(self, "gateway/" + island.name, gateway_behavior, std::move(gateway));
}

/// The sink of an island that only measures: a mote like the others, but fed by its cable.
void spawn_measuring_sink(ecology_pointer self, const config::island_description& island,
                          radio::radio_index radio, const air_actor& air) {
  mote_arguments x;
  x.address = {island.id, island.sink.id};
  x.name = island.name + "/sink";
  x.stack = config::stack::mac;
  x.apps = island.sink.apps;
  x.seed = self->state.description.seed;
  x.radio = radio;
  x.air = air;
  x.ecology = handle_of(self);
  const auto path = "mote/" + x.name;
  spawn_child(self, path, mote_behavior, std::make_shared<const mote_arguments>(std::move(x)), 0U);
}

radio::radio_config radio_of(const config::island_description& island) {
  radio::radio_config x;
  x.address = island.sink.id;
  x.pan = static_cast<std::uint16_t>(island.id.value);
  x.place = island.sink.place;
  x.kind = island.sink.platform;
  x.transmit_dbm = island.sink.transmit_dbm;
  x.battery_mah = mains_mah;
  x.promiscuous = island.sink.promiscuous;
  return x;
}

radio::radio_config radio_of(island_id island, const config::mote_description& mote) {
  radio::radio_config x;
  x.address = mote.id;
  x.pan = static_cast<std::uint16_t>(island.value);
  x.place = mote.place;
  x.kind = mote.platform;
  x.transmit_dbm = mote.transmit_dbm;
  x.battery_mah = mote.battery_mah;
  return x;
}

/// The air of one place, and the bridges and motes of its islands.
void spawn_place(ecology_pointer self, const config::air_description& air) {
  auto& state = self->state;
  const auto& description = state.description;
  const auto path = "air/" + air.name;
  radio::channel channel(description.radio, random_stream(description.seed, path));
  std::vector<mote_address> addresses;
  std::vector<const config::island_description*> islands;
  std::size_t radios = 0;
  for (const auto id : air.islands) {
    islands.push_back(&described(self, id));
    radios += 1 + islands.back()->motes.size();
  }
  channel.reserve(radios);
  for (const auto* island : islands) {
    static_cast<void>(channel.add(radio_of(*island), now(self)));
    addresses.push_back({island->id, island->sink.id});
    for (const auto& mote : island->motes) {
      static_cast<void>(channel.add(radio_of(island->id, mote), now(self)));
      addresses.push_back({island->id, mote.id});
    }
  }
  channel.shrink();
  const auto medium = spawn_child(self, path, rubicon::air, std::move(channel),
                                  std::move(addresses), handle_of(self), state.observe_frames);
  radio::radio_index radio{};
  for (const auto* island : islands) {
    if (island->stack == config::stack::full)
      spawn_bridge(self, *island, radio, medium);
    else
      spawn_measuring_sink(self, *island, radio, medium);
    ++radio.value;
    for (const auto& mote : island->motes) {
      auto& entry = state.motes[{island->id, mote.id}];
      entry.arguments =
          std::make_shared<const mote_arguments>(arguments_of(self, *island, mote, radio, medium));
      entry.type = type_name(mote);
      spawn_mote(self, entry);
      ++radio.value;
    }
  }
}

void spawn_peer(ecology_pointer self, peer_id id, const std::string& name,
                const std::string& host) {
  const auto& description = self->state.description;
  peis_peer_arguments x;
  x.config.network.id = id;
  x.config.network.name = name;
  x.config.network.host_name = host.empty() ? name : host; // unplaced: a machine of its own
  x.config.network.network = description.network;
  x.name = name;
  x.seed = description.seed;
  x.ecology = handle_of(self);
  self->state.peers[name] = {id, spawn_child(self, "peis_peer/" + name, peis_peer, std::move(x))};
}

void open_link(ecology_pointer self, const std::string& from, const std::string& to) {
  const auto& [from_id, initiator] = self->state.peers.at(from);
  const auto& [to_id, acceptor] = self->state.peers.at(to);
  const auto link = self->state.next_link++;
  // The acceptor first: it must know the link before the initiator's first octets arrive.
  self->send(acceptor, link_opened{link, {caf::actor_cast<link_end_actor>(initiator)}, false});
  self->send(initiator, link_opened{link, {caf::actor_cast<link_end_actor>(acceptor)}, true});
}

void open_links(ecology_pointer self) {
  const auto& description = self->state.description;
  std::set<std::pair<std::string, std::string>> open;
  const auto connect = [&](const std::string& from, const std::vector<std::string>& links) {
    for (const auto& to : links) {
      if (open.contains({to, from}) || !open.emplace(from, to).second)
        continue; // declared at both ends, or twice
      open_link(self, from, to);
    }
  };
  for (const auto& island : description.islands)
    if (island.stack == config::stack::full)
      connect(island.gateway_name, island.gateway_links);
  for (const auto& peer : description.peers)
    connect(peer.name, peer.links);
}

/// Spawns one app of a peer, whichever kind it is.
struct peer_app_spawner {
  ecology_pointer self;
  const config::peer_description& peer;
  std::size_t number;

  void operator()(const config::proxy_manager_app& x) const {
    proxy_manager_arguments arguments;
    arguments.classes = self->state.description.proxies;
    for (const auto id : x.islands)
      arguments.islands.push_back(managed(id));
    arguments.peer_number = peer.id;
    arguments.peer = handle();
    arguments.ecology = handle_of(self);
    spawn_child(self, "proxy_manager/" + peer.name, proxy_manager, std::move(arguments));
  }

  void operator()(const config::rules_app& x) const {
    std::vector<proxy::rule> rules;
    for (const auto& rule : x.rules)
      rules.push_back(rule_of(rule));
    spawn_child(self, path("rules"), rules_program, std::move(rules), handle(), handle_of(self));
  }

  void operator()(const config::collector_app& x) const {
    spawn_child(self, path("collector"), collector, x.keys, handle());
  }

  [[nodiscard]] managed_island managed(island_id id) const {
    const auto& island = described(self, id);
    managed_island x{id, island.name, {}};
    for (const auto& mote : island.motes)
      x.mote_names[mote.id] = mote.name;
    return x;
  }

  [[nodiscard]] std::string path(const std::string& kind) const {
    return "peer_app/" + peer.name + '/' + kind + '-' + std::to_string(number);
  }

  [[nodiscard]] peis_peer_actor handle() const { return self->state.peers.at(peer.name).second; }
};

} // namespace

void spawn_mote(ecology_pointer self, supervised_mote& mote) {
  auto& actors = self->state.report.actors;
  ++(mote.incarnation == 0 ? actors.spawned : actors.restarted);
  mote.changed = now(self);
  mote.handle =
      scheduler::spawn_at<caf::monitored>(self, "mote/" + mote.arguments->name, mote_behavior,
                                          mote.arguments, std::uint32_t{mote.incarnation});
}

void assemble(ecology_pointer self) {
  const auto& description = self->state.description;
  for (const auto& island : description.islands)
    if (island.stack == config::stack::full)
      spawn_peer(self, gateway_of(island.id), island.gateway_name, island.host);
  for (const auto& peer : description.peers)
    spawn_peer(self, peer.id, peer.name, peer.host);
  open_links(self);
  for (const auto& air : description.airs)
    spawn_place(self, air);
  for (const auto& peer : description.peers) {
    std::size_t number = 0;
    for (const auto& app : peer.apps)
      std::visit(peer_app_spawner{self, peer, ++number}, app);
  }
}

} // namespace rubicon
