// The part of the assembly that makes kernels.
#include <algorithm>
#include <cmath>

#include "actors/messages/supervision.hpp"
#include "actors/peis/peis_bluetooth.hpp"
#include "actors/peis/peis_peer.hpp"
#include "actors/supervision/assembly.hpp"
#include "actors/supervision/mote_assembly.hpp"
#include "peis/wire/host_record.hpp"
#include "peis/wire/link_url.hpp"
#include "peis/wire/package.hpp"

namespace rubicon {

namespace {

/// Of a link of limited bandwidth: what is urgent overtakes all but these octets.
constexpr std::size_t slow_link_window = 8192;
constexpr duration inquiry_max = 5s;               ///< of a real adapter, which its links share
constexpr std::size_t bluetooth_link_window = 512; ///< a quarter of a second at 2 kB/s

/// The peer's part of the description; a gateway has what is there by default.
config::peer_description description_of(ecology_pointer self, const supervised_peer& peer) {
  if (!peer.island)
    return *std::ranges::find(self->state.description.peers, peer.id,
                              &config::peer_description::id);
  const auto& island = island_described(self, *peer.island);
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
  x.ecology = handle_of<ecology_actor>(self);
  peer.handle = spawn_child(*self->state.pcs, self, path, peis_peer, std::move(x));
  peer.changed = now(self);
  peer.powered = true;
  peer.begun = true;
  note_starts(self, peer.incarnation + 1);
}

} // namespace rubicon
