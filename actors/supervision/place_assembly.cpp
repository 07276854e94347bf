#include "actors/supervision/place_assembly.hpp"

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "actors/island/air.hpp"
#include "actors/messages/air.hpp"
#include "actors/messages/supervision.hpp"
#include "actors/supervision/bridge_assembly.hpp"
#include "actors/supervision/mote_assembly.hpp"
#include "scheduler/coordinator.hpp"

namespace rubicon {

namespace {

/// Sinks are fed by their basestation's USB port.
constexpr double mains_mah = 1e9;

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
      x.mote = mote_described(self, second->mote);
      x.mote.name += "-double";
      x.mote.place = second->place;
    } else if (const auto* move = std::get_if<config::move_island_fault>(&faults[i].what)) {
      x.island = move->to;
      x.mote = mote_described(self, move->mote);
      x.mote.place = move->place;
    } else {
      continue;
    }
    x.mote.path.clear();
    if (std::ranges::find(air.islands, x.island) == air.islands.end())
      continue;
    x.radio = channel.add(radio_of(island_described(self, x.island), x.mote), now(self));
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
    const auto& island = island_described(self, id);
    if (!config::has_line(island.stack))
      continue;
    latency = std::min(latency, island.serial.latency);
    for (const auto& alias : island.aliases)
      latency = std::min(latency, alias.serial.latency);
  }
  // Without latency neither side may be ahead of the other.
  auto& its = latency == duration{} ? *state.pcs : scheduler.add_process();
  if (latency > duration{} && latency < duration::max()) {
    scheduler.rounds().link(its, *state.pcs, latency);
    scheduler.rounds().link(*state.pcs, its, latency);
  }
  for (const auto id : air.islands)
    state.processes[id] = &its;
  return its;
}

} // namespace

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
    islands.push_back(&island_described(self, id));
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
  const auto medium =
      spawn_child(process, self, path, rubicon::air, std::move(channel), std::move(addresses),
                  extra_radios{motes.size(), extra.size()}, description.seed,
                  handle_of<ecology_actor>(self), state.observe_frames);
  for (std::uint32_t i = 0; i < extra.size(); ++i)
    state.noises[extra[i]] = {medium, radio::radio_index{first_noise.value + i}};
  for (const auto* island : islands)
    spawn_backbones(self, *island);
  for (const auto& x : motes)
    state.successors[x.fault] = std::make_shared<const mote_arguments>(
        arguments_of(self, island_described(self, x.island), x.mote, state.traffic.at(x.island),
                     x.radio, medium));
  radio::radio_index radio{};
  for (const auto* island : islands) {
    state.airs[island->id] = medium;
    spawn_bridge(self, *island, radio, medium);
    ++radio.value;
    spawn_motes(self, *island, radio, medium);
    radio.value += static_cast<std::uint32_t>(island->motes.size());
  }
}

} // namespace rubicon
