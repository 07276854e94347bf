// The part of the assembly that makes peers: kernels and the programs that use them.
#include <algorithm>
#include <cmath>

#include "actors/bridge/mqtt_component.hpp"
#include "actors/bridge/ros2_component.hpp"
#include "actors/island/mote.hpp"
#include "actors/messages/programs.hpp"
#include "actors/messages/services.hpp"
#include "actors/messages/supervision.hpp"
#include "actors/peis/component.hpp"
#include "actors/peis/init.hpp"
#include "actors/peis/pc.hpp"
#include "actors/peis/peis_bluetooth.hpp"
#include "actors/peis/peis_peer.hpp"
#include "actors/serial/forwarder_server.hpp"
#include "actors/services/gateway.hpp"
#include "actors/services/object_manager.hpp"
#include "actors/services/proxy_manager.hpp"
#include "actors/supervision/assembly.hpp"
#include "apps/tables.hpp"
#include "bridge/mqtt/mqtt_settings.hpp"
#include "bridge/mqtt/simulated_component.hpp"
#include "bridge/ros2/ros2_settings.hpp"
#include "bridge/ros2/simulated_ros2.hpp"
#include "goal/component.hpp"
#include "io/process/machine.hpp"
#include "peis/wire/host_record.hpp"
#include "peis/wire/link_url.hpp"
#include "peis/wire/package.hpp"
#include "proxy/collector.hpp"
#include "proxy/rules/rules_component.hpp"
#include "rfid/reader.hpp"
#include "translate/component.hpp"

namespace rubicon {

namespace {

/// Of a link of limited bandwidth: what is urgent overtakes all but these octets.
constexpr std::size_t slow_link_window = 8192;
constexpr duration inquiry_max = 5s;               ///< of a real adapter, which its links share
constexpr std::size_t bluetooth_link_window = 512; ///< a quarter of a second at 2 kB/s

ecology_actor ecology_handle(ecology_pointer self) {
  return handle_of<ecology_actor>(self);
}

/// @pre the description has an island with this id, here or on another host
const config::island_description& description_of(ecology_pointer self, island_id id) {
  const config::island_description* found = nullptr;
  config::for_each_island(self->state.description, [&](const auto& x) {
    if (x.id == id)
      found = &x;
  });
  return *found;
}

/// The peer's part of the description; a gateway has what is there by default.
config::peer_description description_of(ecology_pointer self, const supervised_peer& peer) {
  if (!peer.island)
    return *std::ranges::find(self->state.description.peers, peer.id,
                              &config::peer_description::id);
  const auto& island = description_of(self, *peer.island);
  config::peer_description x;
  x.id = peer.id;
  x.name = peer.name;
  x.host = island.host;
  x.links = peer.line == 0 ? island.gateway_links : island.aliases[peer.line - 1].links;
  x.discovery = x.links.empty();
  return x;
}

/// Whether a peer has anything to do with the real network; never in virtual time.
bool is_real(ecology_pointer self, const config::peer_description& peer) {
  return self->state.process.loop != nullptr && config::has_real_links(peer);
}

/// Unplaced peers have a machine of their own, unless they can be met on this one or are a
/// component on that of their init.
std::string host_of(ecology_pointer self, const config::peer_description& peer) {
  if (!peer.host.empty())
    return peer.host;
  if (peer.init)
    return host_of(self, *std::ranges::find(self->state.description.peers, *peer.init,
                                            &config::peer_description::id));
  return is_real(self, peer) ? self->state.process.machine : peer.name;
}

/// Where a peer takes links over Bluetooth: each of a machine has a port of its own.
std::uint16_t bluetooth_port_of(ecology_pointer self, const config::peer_description& peer) {
  const auto machine = host_of(self, peer);
  std::size_t before = 0;
  for (const auto& each : self->state.description.peers)
    before += each.id < peer.id && host_of(self, each) == machine ? 1 : 0;
  return peis::bluetooth_port(before);
}

/// What a full package takes: its acknowledgement cannot come sooner.
duration full_package_time(const config::bluetooth_description& x) {
  constexpr std::int64_t bits = 8 * (peis::header_size + peis::data_max);
  return duration(bits * 1'000'000'000 / static_cast<std::int64_t>(x.rate_bps));
}

void add_bluetooth(ecology_pointer self, const config::peer_description& peer,
                   peis::p2p_config& network) {
  const auto& given = self->state.description.peis.bluetooth;
  if (!peer.adapter.empty() && is_real(self, peer))
    network.bluetooth.adapters = {peer.adapter};
  else if (!peer.bluetooth.empty())
    network.bluetooth.adapters = peer.bluetooth;
  else
    return;
  network.bluetooth.scan_period = given.scan_period;
  network.bluetooth.threshold_dbm = static_cast<int>(std::ceil(given.threshold_dbm));
  if (peer.bluetooth.empty()) // the address of a real adapter is known when it is open
    return;
  const auto port = bluetooth_port_of(self, peer);
  for (const auto& adapter : peer.bluetooth)
    network.addresses.push_back(peis::bluetooth_interface(
        adapter, peis::address_of_adapter(network.host_name, adapter), port));
  if (given.rate_bps == 0)
    return;
  network.link_window = bluetooth_link_window;
  network.reliable.retry_time = std::max(network.reliable.retry_time, 2 * full_package_time(given));
}

peis::kernel_config kernel_of(ecology_pointer self, const config::peer_description& peer) {
  const auto& state = self->state;
  peis::kernel_config x;
  x.managers = peer.managers;
  auto& network = x.network;
  network.id = peer.id;
  network.name = peer.name;
  network.host_name = host_of(self, peer);
  network.network = state.description.network;
  network.process = state.process.number;
  network.clock_offset = state.process.clock_offset + peer.clock_offset;
  network.clock_ppb = static_cast<std::int64_t>(peer.clock_ppm * 1000);
  if (peer.wired)
    network.addresses = {peis::inproc_address(state.process.number, peer.id)};
  if (state.description.peis.bandwidth_bps > 0)
    network.link_window = slow_link_window;
  add_bluetooth(self, peer, network);
  network.time_master = peer.time_master;
  auto& connections = network.connections;
  for (const auto& name : peer.links)
    connections.always.push_back("inproc://" + to_string(state.peers.at(name).id));
  connections.always.insert(connections.always.end(), peer.connect.begin(), peer.connect.end());
  if (peer.tcp)
    connections.networks = peer.tcp->networks;
  connections.leaf = peer.leaf;
  connections.manager = peer.manager;
  connections.announces = peer.discovery || peer.lan;
  return x;
}

/// What a peer has of the real network; nothing in virtual time.
std::optional<real_links_config> real_links_of(ecology_pointer self,
                                               const config::peer_description& peer) {
  if (!is_real(self, peer))
    return std::nullopt;
  real_links_config x;
  x.loop = self->state.process.loop;
  x.links.lan = peer.lan;
  x.links.udp = peer.udp;
  x.links.first_link = peis::link_id{first_real_link};
  if (peer.tcp) {
    x.links.listen_address = peer.tcp->address;
    x.links.networks = peer.tcp->networks;
  }
  if (peer.tcp && peer.tcp->port)
    x.links.first_port = peer.tcp->port;
  else if (!peer.tcp && !peer.lan)
    x.links.first_port.reset();
  x.port_is_given = peer.tcp && peer.tcp->port;
  x.adapter = peer.adapter;
  x.inquiry =
      std::min<duration>(inquiry_max, self->state.description.peis.bluetooth.scan_period / 2);
  return x;
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
    const auto& island = description_of(self, id);
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

} // namespace

void spawn_kernel(ecology_pointer self, supervised_peer& peer, const std::string& path) {
  const auto description = description_of(self, peer);
  peis_peer_arguments x;
  x.config = kernel_of(self, description);
  peer.machine = x.config.network.host_name;
  x.name = peer.name;
  x.seed = self->state.description.seed;
  x.station = peer.station = ++self->state.stations;
  x.incarnation = peer.incarnation;
  x.is_first = !peer.begun;
  x.network = self->state.description.peis;
  x.discovery = description.discovery;
  x.real = real_links_of(self, description);
  if (description.wired)
    x.lan = self->state.lan;
  if (!description.bluetooth.empty()) {
    x.bluetooth = self->state.bluetooth;
    x.adapters = {x.station,         x.config.network.host_name,           description.bluetooth,
                  description.place, bluetooth_port_of(self, description), {}};
  }
  x.ecology = ecology_handle(self);
  peer.handle = spawn_child(*self->state.pcs, self, path, peis_peer, std::move(x));
  peer.changed = now(self);
  peer.powered = true;
  peer.begun = true;
  note_starts(self, peer.incarnation + 1);
}

namespace {

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

} // namespace

void spawn_programs(ecology_pointer self, supervised_peer& peer) {
  if (!peer.island) {
    std::size_t number = 0;
    const auto& apps = description_of(self, peer).apps;
    auto programs = configs_of(programs_among(apps));
    const auto streams = streams_of_proxies(self, apps);
    program_node_actor layer;
    if (streams > 0)
      layer = spawn_pc(self, peer, programs, streams);
    for (const auto& app : apps)
      std::visit(peer_app_spawner{self, peer, ++number, layer}, app);
    if (!layer && !programs.empty())
      spawn_pc(self, peer, std::move(programs), 0);
    return;
  }
  const auto& island = description_of(self, *peer.island);
  const bool is_alias = peer.line > 0;
  gateway_arguments gateway;
  gateway.config.island = island.id;
  gateway.config.tick_period = self->state.description.tick;
  gateway.config.slacks = self->state.slacks;
  if (!island.aliases.empty())
    gateway.config.gateways = config::gateways_of(island);
  gateway.config.incarnation = peer.incarnation;
  gateway.config.form = island.gateway_wire;
  gateway.name = peer.name;
  gateway.self = peer.id;
  gateway.programs = island.gateway_apps;
  gateway.config.channels_max = apps::ends_max(gateway.config.channels_max, gateway.programs);
  const auto slowness = line_slowness(island);
  gateway.config.ack_wait *= slowness;
  gateway.config.lead_lease *= slowness;
  gateway.config.line_silence_max *= slowness;
  gateway.config.shared_silence_max *= slowness;
  const auto& line = is_alias ? island.aliases[peer.line - 1].serial : island.serial;
  gateway.port.baud = line.baud;
  gateway.port.latency = line.latency;
  gateway.port.window = slowness > 1 ? 2 : 1;
  gateway.port.queue_max = std::min(gateway.port.queue_max, serial::queue_room(line.baud)) +
                           self->state.traffic.at(island.id).down.packets;
  gateway.seed = self->state.description.seed;
  gateway.peer = peer.handle;
  gateway.line = self->state.lines.at({island.id, peer.line});
  gateway.line_is_real = island.outside.has_sink();
  gateway.plain.motes = {island.plain, island.keep_alive};
  gateway.plain.group = serial::default_group;
  const auto payload_of = [](const serial::outside_config& x) {
    return x.payload == 0 ? serial::base_station_payload : x.payload;
  };
  if (config::has_plain_sink(island))
    gateway.port.payload_max = payload_of(island.outside);
  gateway.config.is_forwarded =
      !(island.real.is_there() ? island.real.outside : island.outside).forwarder.empty();
  gateway.may_be_own_sink = gateway.line_is_real && island.outside.payload == 0;
  if (const auto& real = island.real; real.is_there()) {
    gateway.config.has_real_line = true;
    gateway.plain.range = real.motes;
    gateway.real_port.baud = real.serial.baud;
    gateway.real_port.payload_max = payload_of(real.outside);
    gateway.real_line = self->state.real_lines.at(island.id);
  }
  gateway.ecology = ecology_handle(self);
  if (!is_alias && !island.exported.forwarder.empty()) {
    gateway.forwarder = spawn_child(
        *self->state.pcs, self, "forwarder_server/" + island.name, forwarder_server,
        forwarder_server_arguments{island.exported.forwarder, island.exported.networks,
                                   self->state.process.loop, island.id, ecology_handle(self)});
    peer.programs.push_back(gateway.forwarder.strong());
  }
  const auto path = "gateway/" + island.name + (is_alias ? '/' + peer.name : std::string());
  peer.programs.push_back(
      spawn_child(*self->state.pcs, self, path, gateway_behavior, std::move(gateway)).strong());
}

} // namespace rubicon
