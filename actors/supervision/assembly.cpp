#include "actors/supervision/assembly.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "actors/island/air.hpp"
#include "actors/island/base_station.hpp"
#include "actors/island/mote.hpp"
#include "actors/island/program.hpp"
#include "actors/island/program_host.hpp"
#include "actors/island/sink.hpp"
#include "actors/messages/air.hpp"
#include "actors/messages/programs.hpp"
#include "actors/messages/serial.hpp"
#include "actors/messages/supervision.hpp"
#include "actors/peis/peis_bluetooth.hpp"
#include "actors/peis/peis_lan.hpp"
#include "actors/serial/backbone.hpp"
#include "actors/serial/outside_line.hpp"
#include "actors/serial/pty_end.hpp"
#include "actors/serial/replay_line.hpp"
#include "actors/serial/serial_line.hpp"
#include "apps/tables.hpp"
#include "config/checks/slot_check.hpp"
#include "scheduler/coordinator.hpp"
#include "scheduler/messages/spawn.hpp"
#include "smepp/crypto/randomness.hpp"

namespace rubicon {

namespace {

/// Sinks are fed by their basestation's USB port.
constexpr double mains_mah = 1e9;

ecology_actor handle_of(ecology_pointer self) {
  return handle_of<ecology_actor>(self);
}

/// @pre the description has an island with this id
const config::island_description& own_island(ecology_pointer self, island_id id) {
  return *std::ranges::find(self->state.description.islands, id, &config::island_description::id);
}

/// @pre the description has a mote with this address
const config::mote_description& own_mote(ecology_pointer self, const mote_address& x) {
  return *std::ranges::find(own_island(self, x.island).motes, x.mote,
                            &config::mote_description::id);
}

std::string type_name(const config::mote_description& x) {
  return x.type_name.empty() ? std::to_string(x.type) : x.type_name;
}

/// How often a mote promises to be heard.
duration keep_alive_of(const config::island_description& island,
                       const config::mote_description& mote) {
  auto period = silence_max(island) / 5;
  for (const auto& app : mote.apps) {
    const auto* sampler = std::get_if<config::sampler_app>(&app);
    if (sampler != nullptr && !sampler->only_subscribed)
      period = std::max({period, sampler->every, sampler->silence_max});
  }
  return period;
}

/// @param who names a mote or a sink
mote::crystal crystal_of(ecology_pointer self, const config::island_description& island,
                         const std::string& who) {
  random_stream rng(self->state.description.seed, "crystal/" + who);
  const auto bound = static_cast<std::uint64_t>(island.crystal_ppm * 1000);
  mote::crystal_config x;
  x.ppb = static_cast<std::int64_t>(rng.below(2 * bound + 1)) - static_cast<std::int64_t>(bound);
  x.wander_ppb = static_cast<std::int64_t>(island.crystal_wander_ppm * 1000);
  x.wander_period = island.crystal_wander_period;
  x.phase = rng.between(0s, x.wander_period);
  return mote::crystal(x);
}

/// The serial number of a mote's hardware, never 0.
std::uint32_t device_of(ecology_pointer self, const std::string& name) {
  return static_cast<std::uint32_t>(
             random_stream(self->state.description.seed, "device/" + name).next()) |
         1U;
}

/// What a mote's members of groups need; nullptr if it has none.
std::shared_ptr<const smepp::node_config> groups_of(ecology_pointer self,
                                                    const config::island_description& island,
                                                    const config::mote_description& mote) {
  const auto& all = self->state.description.smepp;
  smepp::node_config x;
  for (const auto& app : mote.apps)
    if (const auto* member = std::get_if<config::member_app>(&app))
      x.members.emplace_back(
          *member, *std::ranges::find(all.groups, member->group, &smepp::group_description::name));
  if (x.members.empty())
    return nullptr;
  x.self = mote.id;
  x.is_real = self->state.description.mode == config::run_mode::wall;
  x.settings = all;
  for (const auto& each : mote.transducers)
    x.transducers |= smepp::mask_of(each.kind);
  const auto is_member = [](const auto& app) {
    return std::holds_alternative<config::member_app>(app);
  };
  if (all.authenticates_sender) // each pair has a key
    for (const auto& other : island.motes)
      if (other.id != mote.id && std::ranges::any_of(other.apps, is_member))
        x.others.push_back(other.id);
  return std::make_shared<const smepp::node_config>(std::move(x));
}

/// The store of a mote whose frames may have been counted by earlier processes: the high half of
/// its counters is this process's alone. Nobody counts the starts of a run in wall time that is no
/// part of a deployment: it draws it, from a half that starts do not reach.
smepp::persistent_state first_state(std::uint32_t starts, bool is_real) {
  constexpr unsigned frames_of_a_process = 32; // bits
  if (is_real && starts == 0) {
    std::array<std::uint8_t, 4> drawn{};
    smepp::randomness().fill(drawn);
    for (const auto each : drawn)
      starts = starts << 8 | each;
    starts |= 1U << 31U;
  }
  smepp::persistent_state x;
  x.counter_reserved = std::uint64_t{starts} << frames_of_a_process;
  x.counter_end = x.counter_reserved | std::numeric_limits<std::uint32_t>::max();
  return x;
}

/// @param programs of a mote
/// @param traffic of all motes of the island
std::shared_ptr<const mote::node_tables> tables_of(ecology_pointer self, island_id island,
                                                   const std::vector<apps::app_config>& programs,
                                                   const apps::traffic& traffic) {
  auto& common = self->state.tables[island];
  if (programs.empty() && common)
    return common;
  mote::node_tables x;
  x.layer.synaptic.tick_period = self->state.description.tick;
  x.layer.messages.slacks = self->state.slacks;
  x.layer.home = island;
  apps::make_room(x.layer, programs);
  apps::make_room(x.network, apps::traffic_of(island, programs), traffic);
  auto made = std::make_shared<const mote::node_tables>(std::move(x));
  if (programs.empty())
    common = made;
  return made;
}

/// How far the age of a packet may be wrong.
std::chrono::microseconds doubt_of(const serial::backbone_config& x) {
  return std::chrono::ceil<std::chrono::microseconds>(x.jitter / 2);
}

/// Of the further sinks of an island; before these.
void spawn_backbones(ecology_pointer self, const config::island_description& island) {
  for (const auto& mote : island.motes) {
    if (!mote.backbone)
      continue;
    const auto path = "backbone/" + island.name + '/' + mote.name;
    self->state.backbones[{island.id, mote.id}] = spawn_child(
        *self->state.processes.at(island.id), self, path, backbone,
        serial::backbone(*mote.backbone, random_stream(self->state.description.seed, path)),
        backbone_place{island.id, island.sink.id, mote.id}, handle_of(self));
  }
}

mote_arguments arguments_of(ecology_pointer self, const config::island_description& island,
                            const config::mote_description& mote, const apps::traffic& traffic,
                            radio::radio_index radio, const air_actor& air) {
  mote_arguments x;
  x.address = {island.id, mote.id};
  x.name = island.name + '/' + mote.name;
  x.crystal = crystal_of(self, island, x.name);
  x.node.duty = island.duty;
  x.node.place = mote.place;
  x.node.transducer_seed =
      random_stream(self->state.description.seed, x.name + "/transducers").next();
  x.node.device = device_of(self, x.name);
  x.node.id = mote.id;
  x.node.type = mote.type;
  x.node.keep_alive = keep_alive_of(island, mote);
  x.stack = island.stack;
  x.path = mote.path;
  x.step = mote.step;
  x.stays_when_flat = mote.stays_when_flat;
  x.node.transducers = mote.transducers;
  x.node.actuators = mote.actuators;
  x.apps = mote.apps;
  x.smepp = groups_of(self, island, mote);
  if (x.smepp)
    x.smepp_state = std::make_shared<smepp::persistent_state>(
        first_state(self->state.process.starts, x.smepp->is_real));
  x.node.tables = tables_of(self, island.id, configs_of(programs_among(mote.apps)), traffic);
  x.node.access = config::access_of(self->state.description.radio, island);
  x.seed = self->state.description.seed;
  x.radio = radio;
  x.air = air;
  if (mote.backbone) {
    x.node.backbone = {{island.sink.id}, doubt_of(*mote.backbone)};
    x.backbone = self->state.backbones.at(x.address);
  }
  x.ecology = handle_of(self);
  return x;
}

serial_line_actor spawn_line(ecology_pointer self, island_id island, const std::string& path,
                             const serial::line_config& config) {
  return spawn_child(*self->state.processes.at(island), self, path, serial_line,
                     serial::line(config, random_stream(self->state.description.seed, path)),
                     config.latency, island, handle_of(self));
}

/// Where others find the sink of an island whose gateway is not here.
void spawn_pty(ecology_pointer self, const config::island_description& island) {
  pty_end_arguments x;
  x.link = island.outside.pty;
  x.buffer = island.serial.buffer;
  x.loop = self->state.process.loop;
  x.island = island.id;
  x.line = self->state.lines.at({island.id, 0});
  x.ecology = handle_of(self);
  spawn_child(*self->state.pcs, self, "pty_end/" + island.name, pty_end, std::move(x));
}

/// A line to what is not simulated.
serial_line_actor spawn_line(ecology_pointer self, island_id island, const std::string& path,
                             const serial::line_config& config,
                             const serial::outside_config& outside) {
  if (outside.recorded)
    return spawn_child(*self->state.pcs, self, path, replay_line,
                       serial::replay(outside.recorded, outside.speed), island, handle_of(self));
  outside_line_arguments x;
  x.access = {outside, config.baud, config.buffer};
  x.loop = self->state.process.loop;
  x.island = island;
  x.ecology = handle_of(self);
  return spawn_child(*self->state.pcs, self, path, outside_line, std::move(x));
}

/// The way to the real sink of an island, and its gateway.
void spawn_outside(ecology_pointer self, const config::island_description& island) {
  self->state.lines[{island.id, 0}] =
      spawn_line(self, island.id, "serial_line/" + island.name, island.serial, island.outside);
  spawn_programs(self, self->state.peers.at(island.gateway_name));
}

/// The serial lines, sink and gateways of an island.
void spawn_bridge(ecology_pointer self, const config::island_description& island,
                  const apps::traffic& traffic, radio::radio_index radio, const air_actor& air) {
  auto& lines = self->state.lines;
  sink_arguments at_sink;
  apps::make_room(at_sink.network, {}, traffic);
  const auto add_line = [&](const std::string& path, const serial::line_config& config) {
    const auto line = spawn_line(self, island.id, "serial_line/" + path, config);
    lines[{island.id, at_sink.lines.size()}] = line;
    serial::mote_port_config port;
    port.baud = config.baud;
    port.queue_max = std::min(port.queue_max, serial::queue_room(config.baud)) + traffic.up.packets;
    if (island.stack == config::stack::plain) { // as TinyOS has it, whatever the line
      port.queue_max = serial::mote_port_config{}.queue_max;
      port.payload_max = serial::base_station_payload;
    }
    at_sink.lines.push_back({line, port});
  };
  add_line(island.name, island.serial);
  for (const auto& alias : island.aliases) {
    add_line(island.name + '/' + alias.name, alias.serial);
    at_sink.registrar.aliases.emplace_back(static_cast<std::uint32_t>(alias.id.value));
  }
  at_sink.registrar.island = island.id;
  at_sink.registrar.keep_alive_window = silence_max(island);
  const auto slowness = line_slowness(island);
  at_sink.registrar.roster_period *= slowness;
  at_sink.registrar.roster_page_gap *= slowness;
  at_sink.address = {island.id, island.sink.id};
  for (const auto& mote : island.motes) {
    if (!mote.backbone)
      continue;
    at_sink.backbones.push_back({mote.id, self->state.backbones.at({island.id, mote.id})});
    auto& ends = at_sink.network.backbone;
    ends.motes.push_back(mote.id);
    ends.doubt = std::max(ends.doubt, doubt_of(*mote.backbone));
  }
  at_sink.radio = radio;
  at_sink.air = air;
  at_sink.apps = island.sink.apps;
  at_sink.is_base_station = island.stack == config::stack::plain;
  at_sink.duty = island.duty;
  at_sink.network.wake = island.listening.train();
  at_sink.tick = self->state.description.tick;
  at_sink.crystal = crystal_of(self, island, island.name + "/sink");
  at_sink.seed = self->state.description.seed;
  at_sink.ecology = handle_of(self);
  auto& sink = self->state.sinks[island.id];
  sink.path = "sink/" + island.name;
  sink.store.starts = sink.store.term = self->state.process.starts;
  sink.arguments = std::make_shared<const sink_arguments>(std::move(at_sink));
  spawn_sink(self, sink);
  if (island.outside.has_gateway()) {
    spawn_pty(self, island);
    return;
  }
  if (const auto& real = island.real; real.is_there())
    self->state.real_lines[island.id] = spawn_line(
        self, island.id, "real_line/" + island.name + "/real", real.serial, real.outside);
  spawn_programs(self, self->state.peers.at(island.gateway_name));
  for (const auto& alias : island.aliases)
    spawn_programs(self, self->state.peers.at(alias.name));
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
  spawn_child(*self->state.processes.at(island.id), self, path, mote_behavior,
              std::make_shared<const mote_arguments>(std::move(x)), mote::nonvolatile{});
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
  x.access = island.sink.access;
  x.channel = island.channel;
  x.listening = island.listening;
  x.listening.checks = false; // it is fed by its cable
  return x;
}

radio::radio_config radio_of(const config::island_description& island,
                             const config::mote_description& mote) {
  radio::radio_config x;
  x.address = mote.id;
  x.pan = static_cast<std::uint16_t>(island.id.value);
  x.place = mote.place;
  x.kind = mote.platform;
  x.transmit_dbm = mote.transmit_dbm;
  x.battery_mah = mote.backbone ? mains_mah : mote.battery_mah; // its cable feeds it
  x.access = mote.access;
  x.channel = config::channel_of(island, mote);
  x.listening = island.listening;
  return x;
}

/// The mote's programs that are actors of their own wait for it to start.
void spawn_separate_programs(ecology_pointer self, supervised_mote& mote) {
  const auto& of = *mote.arguments;
  for (const auto& each : programs_among(of.apps)) {
    if (!each.is_separate)
      continue;
    program_arguments x;
    x.mote = of.name;
    x.number = each.number;
    x.config = each.config;
    x.crystal = of.crystal;
    x.seed = of.seed;
    x.ecology = of.ecology;
    auto& added = mote.programs.emplace_back();
    added.arguments = std::make_shared<const program_arguments>(std::move(x));
    added.path = "program/" + of.name + '/' + std::string(apps::kind_of(each.config)) + '-' +
                 std::to_string(each.number);
    spawn_program(self, mote, added);
  }
}

/// Of the programs on all motes of an island.
apps::traffic traffic_of(const config::island_description& island) {
  apps::traffic sum;
  for (const auto& mote : island.motes)
    sum += apps::traffic_of(island.id, configs_of(programs_among(mote.apps)));
  return sum;
}

/// Traffic of an island with all that the fault plan makes of its motes, or brings there.
apps::traffic traffic_in(ecology_pointer self, const config::island_description& island) {
  auto sum = traffic_of(island);
  const auto add = [&](const config::mote_description& mote) {
    sum += apps::traffic_of(island.id, configs_of(programs_among(mote.apps)));
  };
  for (const auto& fault : self->state.description.faults) {
    const auto* crash = std::get_if<config::crash_fault>(&fault.what);
    const auto* move = std::get_if<config::move_island_fault>(&fault.what);
    if (crash != nullptr && crash->becomes && crash->mote.island == island.id)
      add(*crash->becomes);
    else if (move != nullptr && move->to == island.id)
      add(own_mote(self, move->mote));
  }
  return sum;
}

/// What motes of an island are once they have failed and have another type.
void note_new_types(ecology_pointer self, const config::island_description& island,
                    const apps::traffic& traffic) {
  auto& state = self->state;
  const auto& faults = state.description.faults;
  for (std::uint32_t i = 0; i < faults.size(); ++i) {
    const auto* crash = std::get_if<config::crash_fault>(&faults[i].what);
    if (crash == nullptr || !crash->becomes || crash->mote.island != island.id)
      continue;
    const auto& before = *state.motes.at(crash->mote).arguments;
    state.successors[i] = std::make_shared<const mote_arguments>(
        arguments_of(self, island, *crash->becomes, traffic, before.radio, before.air));
  }
}

/// A mote that only the fault plan knows in this air, with a radio of its own.
struct extra_mote {
  std::uint32_t fault = 0;
  island_id island;
  config::mote_description mote;
  radio::radio_index radio;
};

/// Second motes with the address of another, and motes that come from elsewhere.
std::vector<extra_mote> add_motes(ecology_pointer self, const config::air_description& air,
                                  radio::channel& channel, std::vector<mote_address>& addresses) {
  std::vector<extra_mote> found;
  const auto& faults = self->state.description.faults;
  for (std::uint32_t i = 0; i < faults.size(); ++i) {
    extra_mote x;
    x.fault = i;
    if (const auto* second = std::get_if<config::mote_double_fault>(&faults[i].what)) {
      x.island = second->mote.island;
      x.mote = own_mote(self, second->mote);
      x.mote.name += "-double";
      x.mote.place = second->place;
    } else if (const auto* move = std::get_if<config::move_island_fault>(&faults[i].what)) {
      x.island = move->to;
      x.mote = own_mote(self, move->mote);
      x.mote.place = move->place;
    } else {
      continue;
    }
    x.mote.path.clear();
    if (std::ranges::find(air.islands, x.island) == air.islands.end())
      continue;
    x.radio = channel.add(radio_of(own_island(self, x.island), x.mote), now(self));
    addresses.push_back({x.island, x.mote.id});
    found.push_back(std::move(x));
  }
  return found;
}

/// Sources of noise that the fault plan has in this air, behind all other radios.
/// @returns the places of these faults
std::vector<std::uint32_t> add_noises(ecology_pointer self, const config::air_description& air,
                                      radio::channel& channel) {
  std::vector<std::uint32_t> found;
  const auto& faults = self->state.description.faults;
  for (std::uint32_t i = 0; i < faults.size(); ++i) {
    const auto* noise = std::get_if<config::noise_fault>(&faults[i].what);
    if (noise == nullptr || std::ranges::find(air.islands, noise->island) == air.islands.end())
      continue;
    radio::radio_config x;
    x.address = no_mote;
    x.pan = static_cast<std::uint16_t>(noise->island.value);
    x.place = noise->place;
    x.kind = radio::find_platform("micaz");
    x.transmit_dbm = noise->transmit_dbm;
    x.battery_mah = mains_mah;
    x.channel = noise->channel.value_or(radio::all_channels);
    static_cast<void>(channel.add(x, now(self)));
    found.push_back(i);
  }
  return found;
}

/// What is at one place: its islands meet each other in the air, and the PCs over their cables.
scheduler::process& add_process(ecology_pointer self, const config::air_description& air) {
  auto& state = self->state;
  auto& scheduler = *scheduler::coordinator::of(self->system());
  auto latency = duration::max();
  for (const auto id : air.islands) {
    const auto& island = own_island(self, id);
    if (!config::has_line(island.stack))
      continue;
    latency = std::min(latency, island.serial.latency);
    for (const auto& alias : island.aliases)
      latency = std::min(latency, alias.serial.latency);
  }
  // Without latency neither side may be ahead of the other.
  auto& its = latency == duration{} ? *state.pcs : scheduler.add_process();
  if (latency > duration{} && latency < duration::max()) {
    scheduler.link(its, *state.pcs, latency);
    scheduler.link(*state.pcs, its, latency);
  }
  for (const auto id : air.islands)
    state.processes[id] = &its;
  return its;
}

/// The air of one place, and the bridges and motes of its islands.
void spawn_place(ecology_pointer self, const config::air_description& air) {
  auto& state = self->state;
  const auto& description = state.description;
  auto& process = add_process(self, air);
  const auto path = "air/" + air.name;
  radio::channel channel(description.radio, random_stream(description.seed, path));
  std::vector<mote_address> addresses;
  std::vector<const config::island_description*> islands;
  std::size_t radios = 0;
  for (const auto id : air.islands) {
    islands.push_back(&own_island(self, id));
    radios += 1 + islands.back()->motes.size();
  }
  channel.reserve(radios);
  for (const auto* island : islands) {
    static_cast<void>(channel.add(radio_of(*island), now(self)));
    addresses.push_back({island->id, island->sink.id});
    for (const auto& mote : island->motes) {
      static_cast<void>(channel.add(radio_of(*island, mote), now(self)));
      addresses.push_back({island->id, mote.id});
    }
  }
  const auto motes = add_motes(self, air, channel, addresses);
  const auto extra = add_noises(self, air, channel);
  channel.shrink();
  const radio::radio_index first_noise{static_cast<std::uint32_t>(addresses.size())};
  const auto medium = spawn_child(process, self, path, rubicon::air, std::move(channel),
                                  std::move(addresses), extra_radios{motes.size(), extra.size()},
                                  description.seed, handle_of(self), state.observe_frames);
  for (std::uint32_t i = 0; i < extra.size(); ++i)
    state.noises[extra[i]] = {medium, radio::radio_index{first_noise.value + i}};
  for (const auto* island : islands)
    spawn_backbones(self, *island);
  for (const auto& x : motes)
    state.successors[x.fault] = std::make_shared<const mote_arguments>(arguments_of(
        self, own_island(self, x.island), x.mote, state.traffic.at(x.island), x.radio, medium));
  radio::radio_index radio{};
  for (const auto* island : islands) {
    state.airs[island->id] = medium;
    const auto& traffic = state.traffic.at(island->id);
    if (config::has_line(island->stack))
      spawn_bridge(self, *island, traffic, radio, medium);
    else
      spawn_measuring_sink(self, *island, radio, medium);
    ++radio.value;
    for (const auto& mote : island->motes) {
      auto& entry = state.motes[{island->id, mote.id}];
      entry.arguments = std::make_shared<const mote_arguments>(
          arguments_of(self, *island, mote, traffic, radio, medium));
      entry.type = type_name(mote);
      entry.store.starts = self->state.process.starts;
      spawn_separate_programs(self, entry);
      spawn_mote(self, entry);
      ++radio.value;
    }
    note_new_types(self, *island, traffic);
  }
}

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

std::int64_t line_slowness(const config::island_description& island) {
  auto most = serial::slowness(island.serial.baud);
  for (const auto& alias : island.aliases)
    most = std::max(most, serial::slowness(alias.serial.baud));
  return most;
}

void spawn_program(ecology_pointer self, const supervised_mote& mote, supervised_program& x) {
  x.handle = spawn_child(*self->state.processes.at(mote.arguments->address.island), self, x.path,
                         program_behavior, x.arguments, std::uint32_t{x.incarnation});
  if (mote.handle)
    self->send(x.handle, mote_started{{mote.handle}});
}

void spawn_sink(ecology_pointer self, supervised_sink& x) {
  if (x.store.starts > self->state.process.starts) {
    ++self->state.report.actors.restarted;
    --self->state.report.actors.spawned;
  }
  x.changed = now(self);
  x.handle = spawn_child(*self->state.processes.at(x.arguments->address.island), self, x.path,
                         x.arguments->is_base_station ? base_station : sink,
                         sink_arguments{*x.arguments}, mote::nonvolatile{x.store});
}

void spawn_mote(ecology_pointer self, supervised_mote& mote) {
  auto& actors = self->state.report.actors;
  ++(mote.store.starts == self->state.process.starts ? actors.spawned : actors.restarted);
  mote.changed = now(self);
  mote.handle = scheduler::spawn_in<scheduler::monitored>(
      *self->state.processes.at(mote.arguments->address.island), self,
      "mote/" + mote.arguments->name, mote_behavior, mote.arguments, mote::nonvolatile{mote.store});
  for (const auto& x : mote.programs) {
    if (x.handle)
      self->send(x.handle, mote_started{{mote.handle}});
  }
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
