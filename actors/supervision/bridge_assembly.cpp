#include "actors/supervision/bridge_assembly.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "actors/island/base_station.hpp"
#include "actors/island/mote.hpp"
#include "actors/island/sink.hpp"
#include "actors/messages/serial.hpp"
#include "actors/messages/supervision.hpp"
#include "actors/serial/backbone.hpp"
#include "actors/serial/outside_line.hpp"
#include "actors/serial/pty_end.hpp"
#include "actors/serial/replay_line.hpp"
#include "actors/serial/serial_line.hpp"
#include "actors/supervision/mote_assembly.hpp"
#include "apps/tables.hpp"

namespace rubicon {

namespace {

serial_line_actor spawn_line(ecology_pointer self, island_id island, const std::string& path,
                             const serial::line_config& config) {
  return spawn_child(*self->state.processes.at(island), self, path, serial_line,
                     serial::line(config, random_stream(self->state.description.seed, path)),
                     config.latency, island, handle_of<ecology_actor>(self));
}

/// Where others find the sink of an island whose gateway is not here.
void spawn_pty(ecology_pointer self, const config::island_description& island) {
  pty_end_arguments x;
  x.link = island.outside.pty;
  x.buffer = island.serial.buffer;
  x.loop = self->state.process.loop;
  x.island = island.id;
  x.line = self->state.lines.at({island.id, 0});
  x.ecology = handle_of<ecology_actor>(self);
  spawn_child(*self->state.pcs, self, "pty_end/" + island.name, pty_end, std::move(x));
}

/// A line to what is not simulated.
serial_line_actor spawn_line(ecology_pointer self, island_id island, const std::string& path,
                             const serial::line_config& config,
                             const serial::outside_config& outside) {
  if (outside.recorded)
    return spawn_child(*self->state.pcs, self, path, replay_line,
                       serial::replay(outside.recorded, outside.speed), island,
                       handle_of<ecology_actor>(self));
  outside_line_arguments x;
  x.access = {outside, config.baud, config.buffer};
  x.loop = self->state.process.loop;
  x.island = island;
  x.ecology = handle_of<ecology_actor>(self);
  return spawn_child(*self->state.pcs, self, path, outside_line, std::move(x));
}

/// The serial lines, sink and gateways of an island.
void spawn_full_bridge(ecology_pointer self, const config::island_description& island,
                       const apps::traffic& traffic, radio::radio_index radio,
                       const air_actor& air) {
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
  at_sink.ecology = handle_of<ecology_actor>(self);
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
  x.ecology = handle_of<ecology_actor>(self);
  const auto path = "mote/" + x.name;
  spawn_child(*self->state.processes.at(island.id), self, path, mote_behavior,
              std::make_shared<const mote_arguments>(std::move(x)), mote::nonvolatile{});
}

} // namespace

std::chrono::microseconds doubt_of(const serial::backbone_config& x) {
  return std::chrono::ceil<std::chrono::microseconds>(x.jitter / 2);
}

void spawn_backbones(ecology_pointer self, const config::island_description& island) {
  for (const auto& mote : island.motes) {
    if (!mote.backbone)
      continue;
    const auto path = "backbone/" + island.name + '/' + mote.name;
    self->state.backbones[{island.id, mote.id}] = spawn_child(
        *self->state.processes.at(island.id), self, path, backbone,
        serial::backbone(*mote.backbone, random_stream(self->state.description.seed, path)),
        backbone_place{island.id, island.sink.id, mote.id}, handle_of<ecology_actor>(self));
  }
}

void spawn_outside(ecology_pointer self, const config::island_description& island) {
  self->state.lines[{island.id, 0}] =
      spawn_line(self, island.id, "serial_line/" + island.name, island.serial, island.outside);
  spawn_programs(self, self->state.peers.at(island.gateway_name));
}

void spawn_bridge(ecology_pointer self, const config::island_description& island,
                  radio::radio_index radio, const air_actor& air) {
  if (config::has_line(island.stack))
    spawn_full_bridge(self, island, self->state.traffic.at(island.id), radio, air);
  else
    spawn_measuring_sink(self, island, radio, air);
}

std::int64_t line_slowness(const config::island_description& island) {
  auto most = serial::slowness(island.serial.baud);
  for (const auto& alias : island.aliases)
    most = std::max(most, serial::slowness(alias.serial.baud));
  return most;
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

} // namespace rubicon
