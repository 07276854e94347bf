// The part of the assembly that makes the programs of peers, which use their kernels.
#include <algorithm>

#include "actors/bridge/mqtt_component.hpp"
#include "actors/bridge/ros2_component.hpp"
#include "actors/messages/programs.hpp"
#include "actors/messages/services.hpp"
#include "actors/messages/supervision.hpp"
#include "actors/peis/component.hpp"
#include "actors/peis/init.hpp"
#include "actors/peis/pc.hpp"
#include "actors/serial/forwarder_server.hpp"
#include "actors/services/gateway.hpp"
#include "actors/services/object_manager.hpp"
#include "actors/services/proxy_manager.hpp"
#include "actors/supervision/assembly.hpp"
#include "actors/supervision/mote_assembly.hpp"
#include "apps/tables.hpp"
#include "bridge/mqtt/mqtt_settings.hpp"
#include "bridge/mqtt/simulated_component.hpp"
#include "bridge/ros2/ros2_settings.hpp"
#include "bridge/ros2/simulated_ros2.hpp"
#include "goal/component.hpp"
#include "io/process/machine.hpp"
#include "proxy/collector.hpp"
#include "proxy/rules/rules_component.hpp"
#include "rfid/reader.hpp"
#include "translate/component.hpp"

namespace rubicon {

namespace {

ecology_actor ecology_handle(ecology_pointer self) {
  return handle_of<ecology_actor>(self);
}

rfid::tags tags_of(const config::ecology_description& x) {
  constexpr duration any_step = 1s; // readers look when they please
  rfid::tags all;
  for (const auto& each : x.tags) {
    auto path = each.path;
    if (path.empty())
      path.push_back({0s, each.place});
    all.push_back({each.id, each.memory, device::walk(std::move(path), any_step)});
  }
  return all;
}

/// Spawns one app of a peer, whichever kind it is.
struct peer_app_spawner {
  ecology_pointer self;
  supervised_peer& peer;
  std::size_t number;
  program_node_actor layer; ///< the peer's; nullptr: no proxy needs it

  void operator()(const config::proxy_manager_app& x) const {
    proxy_manager_arguments arguments;
    arguments.classes = self->state.description.proxies;
    for (const auto id : x.islands)
      arguments.islands.push_back(managed(id));
    arguments.peer_number = peer.id;
    arguments.peer = peer.handle;
    arguments.ecology = ecology_handle(self);
    arguments.layer = layer;
    arguments.peer_name = peer.name;
    peer.managers.push_back(spawn_child(*self->state.pcs, self, "proxy_manager/" + peer.name,
                                        proxy_manager, std::move(arguments)));
    add(peer.managers.back());
    if (x.objects)
      add(spawn_child(*self->state.pcs, self, "object_manager/" + peer.name, object_manager,
                      self->state.description.proxies, peer.name, peer.handle,
                      ecology_handle(self)));
  }

  void operator()(const proxy::rules_config& x) const {
    spawn_component("rules", static_cast<std::uint32_t>(number),
                    std::make_shared<proxy::rules_component>(
                        proxy::rules(x.rules, x.retry, x.clock_changes), peer.away_since));
  }

  void operator()(const apps::app_config&) const {} // all in one actor

  void operator()(const config::collector_app& x) const {
    add_component<proxy::collector>("collector", x.keys, x.every);
  }

  void operator()(const config::translate_app& x) const {
    add_component<translate::component>("translate", translate::translator(x.rules), peer.id);
  }

  void operator()(const rfid::reader_config& x) const {
    auto& tags = self->state.tags;
    if (tags == nullptr)
      tags = std::make_shared<const rfid::tags>(tags_of(self->state.description));
    add_component<rfid::reader>(
        "rfid_reader", x, tags,
        random_stream(self->state.description.seed, "rfid_reader/" + x.name));
  }

  void operator()(const goal::pursuer_config& x) const {
    const auto life = path("goal") + '#' + std::to_string(peer.incarnation);
    add_component<goal::component>(
        "goal", goal::pursuer(x, random_stream(self->state.description.seed, life)), peer.id);
  }

  /// In virtual time the broker is simulated.
  void operator()(const config::mqtt_app& x) const {
    const auto& all = self->state.description;
    std::vector<bridge::class_model> classes;
    for (const auto& each : all.proxies)
      classes.push_back(bridge::model_of(each));
    bridge::mqtt_bridge core(
        x.settings->bridge, std::move(classes),
        random_stream(all.seed, path("mqtt") + '#' + std::to_string(peer.incarnation)));
    const auto lives = static_cast<std::uint32_t>(number);
    if (all.mode == config::run_mode::virtual_time) {
      if (peer.broker == nullptr)
        peer.broker = std::make_shared<bridge::broker_site>(x.settings->simulated);
      return spawn_component(
          "mqtt", lives,
          std::make_shared<bridge::simulated_component>(std::move(core), peer.broker));
    }
    auto client = client_settings(*x.settings);
    if (auto* why = std::get_if<std::string>(&client)) {
      post(ecology_handle(self), request_unmet{path("mqtt"), std::move(*why), true});
      return;
    }
    auto real = std::make_shared<mqtt_component>(
        std::move(core), std::get<io::mqtt_client_settings>(std::move(client)));
    auto* const outside = real.get();
    spawn_component("mqtt", lives, std::move(real), outside);
  }

  /// In virtual time the rosbridge is simulated.
  void operator()(const config::ros2_app& x) const {
    const auto& all = self->state.description;
    random_stream rng(all.seed, path("ros2") + '#' + std::to_string(peer.incarnation));
    if (all.mode == config::run_mode::virtual_time)
      return add_component<bridge::simulated_ros2>(
          "ros2", bridge::ros2_bridge(x.settings->bridge, rng), peer.id);
    auto client = client_settings(*x.settings);
    if (auto* why = std::get_if<std::string>(&client)) {
      post(ecology_handle(self), request_unmet{path("ros2"), std::move(*why), true});
      return;
    }
    const auto epoch =
        std::chrono::microseconds(io::system_clock_us()) - now(self).time_since_epoch();
    auto real = std::make_shared<ros2_component>(
        bridge::ros2_bridge(x.settings->bridge, rng, epoch), peer.id,
        std::get<io::web_client_settings>(std::move(client)));
    auto* const outside = real.get();
    spawn_component("ros2", 0, std::move(real), outside);
  }

  void operator()(const config::init_app& x) const {
    init_arguments arguments;
    arguments.name = peer.name;
    arguments.id = peer.id;
    arguments.components = x.components;
    arguments.loop = self->state.process.loop;
    arguments.lock = x.lock;
    arguments.peer = peer.handle;
    arguments.ecology = ecology_handle(self);
    peer.init = spawn_child(*self->state.pcs, self, "init/" + peer.name, init_behavior,
                            std::move(arguments));
    add(peer.init);
  }

  [[nodiscard]] managed_island managed(island_id id) const {
    const auto& island = island_described(self, id);
    managed_island x{
        id, island.name, {}, {{gateway_of(id), island.gateway_name}}, island.sink.place};
    x.slack = transport::messenger_config::attempts_max *
              slack_of(self->state.slacks, {id, own_mote}).there_and_back;
    for (const auto& alias : island.aliases)
      x.gateways.push_back({alias.id, alias.name});
    for (const auto& [address, mote] : self->state.motes) {
      if (address.island == id)
        x.mote_names[address.mote] = mote.arguments->name.substr(island.name.size() + 1);
    }
    for (const auto& mote : island.motes) // those of islands of other hosts
      x.mote_names.emplace(mote.id, mote.name);
    for (const auto& [mote, name] : island.real.names)
      x.mote_names.emplace(mote, name);
    return x;
  }

  [[nodiscard]] std::string path(const std::string& kind) const {
    return "peer_app/" + peer.name + '/' + kind + '-' + std::to_string(number);
  }

  template <class Core, class... Arguments>
  void add_component(const std::string& kind, Arguments&&... arguments) const {
    spawn_component(kind, 0, std::make_shared<Core>(std::forward<Arguments>(arguments)...));
  }

  /// @param lives number under which its lives are added up, or 0
  /// @param outside the core, if it has a thread of its own
  void spawn_component(const std::string& kind, std::uint32_t lives,
                       std::shared_ptr<components::component> core,
                       components::outside_component* outside = nullptr) const {
    add(spawn_child(*self->state.pcs, self, path(kind), component_behavior,
                    component_arguments{std::move(core), peer.name, kind, lives, peer.id,
                                        peer.handle, ecology_handle(self), outside}));
  }

  template <class Handle>
  void add(const Handle& program) const {
    peer.programs.push_back(program.strong());
  }
};

/// How many streams proxies read at a peer with such programs.
std::size_t streams_of_proxies(ecology_pointer self, const std::vector<config::peer_app>& apps) {
  const bool manages = std::ranges::any_of(apps, [](const config::peer_app& app) {
    return std::holds_alternative<config::proxy_manager_app>(app);
  });
  std::size_t streams = 0;
  for (const auto& each : self->state.description.proxies)
    streams += manages ? proxy::streams_of(each).size() : 0;
  return streams;
}

/// @param streams that proxies read
pc_actor spawn_pc(ecology_pointer self, supervised_peer& peer,
                  std::vector<apps::app_config> programs, std::size_t streams) {
  pc_arguments x;
  x.config.self = peer.id;
  x.config.incarnation = peer.incarnation;
  x.config.awaits_clock = true;
  x.config.tick_period = self->state.description.tick;
  x.config.slacks = self->state.slacks;
  x.config.channels_max = apps::ends_max(x.config.channels_max, programs) + streams;
  config::for_each_island(self->state.description,
                          [&x](const auto& each) { x.aliases |= !each.aliases.empty(); });
  x.name = peer.name;
  x.programs = std::move(programs);
  x.seed = self->state.description.seed;
  x.peer = peer.handle;
  x.ecology = ecology_handle(self);
  auto layer = spawn_child(*self->state.pcs, self, "pc/" + peer.name, pc, std::move(x));
  peer.programs.push_back(layer.strong());
  return layer;
}

/// Its cable, or that of the alias which the peer is.
void add_line(ecology_pointer self, const supervised_peer& peer,
              const config::island_description& island, gateway_arguments& x) {
  const auto slowness = line_slowness(island);
  x.config.ack_wait *= slowness;
  x.config.lead_lease *= slowness;
  x.config.line_silence_max *= slowness;
  x.config.shared_silence_max *= slowness;
  const auto& line = peer.line > 0 ? island.aliases[peer.line - 1].serial : island.serial;
  x.port.baud = line.baud;
  x.port.latency = line.latency;
  x.port.window = slowness > 1 ? 2 : 1;
  x.port.queue_max = std::min(x.port.queue_max, serial::queue_room(line.baud)) +
                     self->state.traffic.at(island.id).down.packets;
  x.line = self->state.lines.at({island.id, peer.line});
}

/// Real motes, at the cable or at one of their own.
void add_real_motes(ecology_pointer self, const config::island_description& island,
                    gateway_arguments& x) {
  x.line_is_real = island.outside.has_sink();
  x.plain.motes = {island.plain, island.keep_alive};
  x.plain.group = serial::default_group;
  const auto payload_of = [](const serial::outside_config& outside) {
    return outside.payload == 0 ? serial::base_station_payload : outside.payload;
  };
  if (config::has_plain_sink(island))
    x.port.payload_max = payload_of(island.outside);
  x.config.is_forwarded =
      !(island.real.is_there() ? island.real.outside : island.outside).forwarder.empty();
  x.may_be_own_sink = x.line_is_real && island.outside.payload == 0;
  if (const auto& real = island.real; real.is_there()) {
    x.config.has_real_line = true;
    x.plain.range = real.motes;
    x.real_port.baud = real.serial.baud;
    x.real_port.payload_max = payload_of(real.outside);
    x.real_line = self->state.real_lines.at(island.id);
  }
}

void spawn_gateway(ecology_pointer self, supervised_peer& peer,
                   const config::island_description& island) {
  gateway_arguments x;
  x.config.island = island.id;
  x.config.tick_period = self->state.description.tick;
  x.config.slacks = self->state.slacks;
  if (!island.aliases.empty())
    x.config.gateways = config::gateways_of(island);
  x.config.incarnation = peer.incarnation;
  x.config.form = island.gateway_wire;
  x.name = peer.name;
  x.self = peer.id;
  x.programs = island.gateway_apps;
  x.config.channels_max = apps::ends_max(x.config.channels_max, x.programs);
  x.seed = self->state.description.seed;
  x.peer = peer.handle;
  x.ecology = ecology_handle(self);
  add_line(self, peer, island, x);
  add_real_motes(self, island, x);
  const bool is_alias = peer.line > 0;
  if (!is_alias && !island.exported.forwarder.empty()) {
    x.forwarder = spawn_child(
        *self->state.pcs, self, "forwarder_server/" + island.name, forwarder_server,
        forwarder_server_arguments{island.exported.forwarder, island.exported.networks,
                                   self->state.process.loop, island.id, ecology_handle(self)});
    peer.programs.push_back(x.forwarder.strong());
  }
  const auto path = "gateway/" + island.name + (is_alias ? '/' + peer.name : std::string());
  peer.programs.push_back(
      spawn_child(*self->state.pcs, self, path, gateway_behavior, std::move(x)).strong());
}

void spawn_apps(ecology_pointer self, supervised_peer& peer,
                const std::vector<config::peer_app>& apps) {
  std::size_t number = 0;
  auto programs = configs_of(programs_among(apps));
  const auto streams = streams_of_proxies(self, apps);
  program_node_actor layer;
  if (streams > 0)
    layer = spawn_pc(self, peer, programs, streams);
  for (const auto& app : apps)
    std::visit(peer_app_spawner{self, peer, ++number, layer}, app);
  if (!layer && !programs.empty())
    spawn_pc(self, peer, std::move(programs), 0);
}

} // namespace

void spawn_programs(ecology_pointer self, supervised_peer& peer) {
  if (peer.island)
    return spawn_gateway(self, peer, island_described(self, *peer.island));
  const auto& peers = self->state.description.peers;
  spawn_apps(self, peer, std::ranges::find(peers, peer.id, &config::peer_description::id)->apps);
}

} // namespace rubicon
