#include "actors/supervision/mote_assembly.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <utility>

#include "actors/island/program.hpp"
#include "actors/island/program_host.hpp"
#include "actors/messages/programs.hpp"
#include "actors/messages/supervision.hpp"
#include "actors/supervision/bridge_assembly.hpp"
#include "apps/tables.hpp"
#include "config/checks/slot_check.hpp"
#include "smepp/crypto/randomness.hpp"

namespace rubicon {

namespace {

std::string type_name(const config::mote_description& x) {
  return x.type_name.empty() ? std::to_string(x.type) : x.type_name;
}

/// How often a mote sends something at least.
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

/// Of the programs on all motes of an island.
apps::traffic traffic_of(const config::island_description& island) {
  apps::traffic sum;
  for (const auto& mote : island.motes)
    sum += apps::traffic_of(island.id, configs_of(programs_among(mote.apps)));
  return sum;
}

} // namespace

const config::island_description& island_described(ecology_pointer self, island_id id) {
  const config::island_description* found = nullptr;
  config::for_each_island(self->state.description, [&](const auto& x) {
    if (x.id == id)
      found = &x;
  });
  return *found;
}

const config::mote_description& mote_described(ecology_pointer self, const mote_address& x) {
  return *std::ranges::find(island_described(self, x.island).motes, x.mote,
                            &config::mote_description::id);
}

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
  x.channel = channel_of(island, mote);
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
  x.ecology = handle_of<ecology_actor>(self);
  return x;
}

void spawn_motes(ecology_pointer self, const config::island_description& island,
                 radio::radio_index radio, const air_actor& air) {
  const auto& traffic = self->state.traffic.at(island.id);
  for (const auto& mote : island.motes) {
    auto& entry = self->state.motes[{island.id, mote.id}];
    entry.arguments = std::make_shared<const mote_arguments>(
        arguments_of(self, island, mote, traffic, radio, air));
    entry.type = type_name(mote);
    entry.store.starts = self->state.process.starts;
    spawn_separate_programs(self, entry);
    spawn_mote(self, entry);
    ++radio.value;
  }
  note_new_types(self, island, traffic);
}

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
      add(mote_described(self, move->mote));
  }
  return sum;
}

void spawn_program(ecology_pointer self, const supervised_mote& mote, supervised_program& x) {
  x.handle = spawn_child(*self->state.processes.at(mote.arguments->address.island), self, x.path,
                         program_behavior, x.arguments, std::uint32_t{x.incarnation});
  if (mote.handle)
    self->send(x.handle, mote_started{{mote.handle}});
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

} // namespace rubicon
