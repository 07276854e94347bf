#include "actors/peis_bluetooth.hpp"

#include <algorithm>
#include <cmath>

#include "core/hash.hpp"
#include "core/math.hpp"
#include "scheduler/supervision.hpp"

namespace rubicon {

namespace {

using bluetooth_pointer = scheduler::traced_pointer<peis_bluetooth_state, peis_bluetooth_actor>;
using adapter = peis_bluetooth_state::adapter;
using station = peis_bluetooth_state::station;

double distance_m(const adapter& a, const adapter& b) {
  return math::length(a.place.x_m - b.place.x_m, a.place.y_m - b.place.y_m,
                      a.place.z_m - b.place.z_m);
}

/// Both on, and near enough.
bool hear(bluetooth_pointer self, const adapter& a, const adapter& b) {
  return a.dark.empty() && b.dark.empty() &&
         distance_m(a, b) <= self->state.network.bluetooth.range_m;
}

/// Links whose ends hear each other no more, or one of which has ended, are closed.
void settle_links(bluetooth_pointer self) {
  auto& state = self->state;
  std::erase_if(state.links, [&](const auto& entry) {
    const auto& [number, link] = entry;
    const auto initiator = state.stations.find(link.initiator);
    const auto acceptor = state.stations.find(link.acceptor);
    const bool both = initiator != state.stations.end() && acceptor != state.stations.end();
    if (both && hear(self, state.adapters.at(link.from), state.adapters.at(link.to)))
      return false;
    for (const auto& end : {initiator, acceptor}) {
      if (end != state.stations.end())
        self->delayed_send(end->second.user, state.network.delay, link_closed{number});
    }
    return true;
  });
}

void on_join(bluetooth_pointer self, const join_bluetooth& x) {
  auto& state = self->state;
  self->monitor(x.user.actor);
  station joined{x.user.actor, {}, x.port};
  for (const auto& name : x.adapters) {
    const auto address = address_of_adapter(x.machine, name);
    joined.adapters[name] = address;
    auto& opened = state.adapters[address];
    if (opened.machine.empty()) {
      opened.machine = x.machine;
      opened.place = x.place;
    }
    opened.stations.push_back(x.station);
    if (!opened.announcer)
      opened.announcer = x.station;
  }
  state.stations[x.station] = std::move(joined);
}

/// The right to announce goes with the process that has it, unless takeover says otherwise.
void on_down(bluetooth_pointer self, const caf::down_msg& x) {
  auto& state = self->state;
  const auto gone = std::ranges::find_if(
      state.stations, [&](const auto& each) { return each.second.user.address() == x.source; });
  if (gone == state.stations.end())
    return;
  for (const auto& [name, address] : gone->second.adapters) {
    auto& opened = state.adapters.at(address);
    std::erase(opened.stations, gone->first);
    if (opened.announcer != gone->first)
      continue;
    opened.announcer.reset();
    if (state.network.bluetooth.takeover && !opened.stations.empty())
      opened.announcer = opened.stations.front();
  }
  state.stations.erase(gone);
  settle_links(self);
}

/// The station's adapter of that name; nullptr if it has none.
const adapter* adapter_of(bluetooth_pointer self, std::uint64_t number, const std::string& name) {
  const auto from = self->state.stations.find(number);
  if (from == self->state.stations.end())
    return nullptr;
  const auto found = from->second.adapters.find(name);
  return found == from->second.adapters.end() ? nullptr : &self->state.adapters.at(found->second);
}

void on_scan(bluetooth_pointer self, const scan_bluetooth& x) {
  const auto* from = adapter_of(self, x.station, x.adapter);
  if (from == nullptr)
    return;
  bluetooth_seen seen{x.adapter, {}};
  for (const auto& [address, other] : self->state.adapters) {
    if (&other != from && hear(self, *from, other))
      seen.devices.push_back({address, bluetooth_strength_dbm(distance_m(*from, other))});
  }
  self->delayed_send(self->state.stations.at(x.station).user, self->state.network.delay,
                     std::move(seen));
}

/// An adapter that can be heard from another and that somebody announces; nullptr if it is not so.
const adapter* announced(bluetooth_pointer self, const adapter& from,
                         const peis::bluetooth_address& address) {
  const auto to = self->state.adapters.find(address);
  const bool answers =
      to != self->state.adapters.end() && to->second.announcer && hear(self, from, to->second);
  return answers ? &to->second : nullptr;
}

/// All who share the adapter answer, if one of them announces.
void on_hello(bluetooth_pointer self, const send_hello& x) {
  auto& state = self->state;
  const auto* from = adapter_of(self, x.station, x.question.adapter);
  if (from == nullptr)
    return;
  const auto& asker = state.stations.at(x.station).user;
  const auto* to = announced(self, *from, x.question.device);
  if (to == nullptr) {
    self->delayed_send(asker, state.network.delay,
                       hello_answer{x.question.adapter, x.question.device, {}});
    return;
  }
  for (const auto number : to->stations)
    self->delayed_send(state.stations.at(number).user, state.network.delay,
                       hello_arrived{x.question, {caf::actor_cast<hello_sender_actor>(asker)}});
}

/// Who takes links at a port of an adapter.
std::map<std::uint64_t, station>::const_iterator listener(bluetooth_pointer self, const adapter& at,
                                                          std::uint16_t port) {
  const auto& stations = self->state.stations;
  const auto found = std::ranges::find_if(
      at.stations, [&](std::uint64_t number) { return stations.at(number).port == port; });
  return found == at.stations.end() ? stations.end() : stations.find(*found);
}

void open_link(bluetooth_pointer self, const bluetooth_connect& x,
               const peis::bluetooth_address& from, std::uint64_t acceptor) {
  auto& state = self->state;
  const auto number = state.next_link++;
  state.links[number] = {x.station, acceptor, from, x.to};
  const auto& near_end = state.stations.at(x.station).user;
  const auto& far_end = state.stations.at(acceptor).user;
  const auto rate_bps = state.network.bluetooth.rate_bps;
  // The acceptor first: it must know the link before the initiator's first octets arrive.
  self->delayed_send(
      far_end, state.network.delay,
      bluetooth_opened{{number, {caf::actor_cast<link_end_actor>(near_end)}, false, 0, {}},
                       rate_bps});
  self->delayed_send(
      near_end, state.network.delay,
      bluetooth_opened{{number, {caf::actor_cast<link_end_actor>(far_end)}, true, x.attempt, {}},
                       rate_bps});
}

void on_connect(bluetooth_pointer self, const bluetooth_connect& x) {
  auto& state = self->state;
  const auto asker = state.stations.find(x.station);
  if (asker == state.stations.end())
    return;
  for (const auto& [name, address] : asker->second.adapters) {
    const auto* to = announced(self, state.adapters.at(address), x.to);
    const auto found = to == nullptr ? state.stations.cend() : listener(self, *to, x.port);
    if (found != state.stations.cend() && found->first != x.station) {
      open_link(self, x, address, found->first);
      return;
    }
  }
  self->delayed_send(asker->second.user, state.network.delay, attempt_failed{x.attempt});
}

void on_power(bluetooth_pointer self, const set_lan_power& x) {
  auto& state = self->state;
  for (auto& [address, each] : state.adapters) {
    if (x.on)
      each.dark.erase(x.station);
    else if (std::ranges::find(each.stations, x.station) != each.stations.end())
      each.dark.insert(x.station);
  }
  settle_links(self);
}

} // namespace

peis::bluetooth_address address_of_adapter(const std::string& machine, const std::string& adapter) {
  auto bits = fold64().add(machine).add(adapter).value();
  peis::bluetooth_address x;
  for (auto& octet : x.octets) {
    octet = static_cast<std::uint8_t>(bits);
    bits >>= 8;
  }
  x.octets[0] = 0x02; // administered locally, no group
  return x;
}

std::uint16_t bluetooth_port(std::size_t n) {
  constexpr std::size_t first = 0x2001; // hello_port is not among them
  constexpr std::size_t odd_octets = 128;
  return static_cast<std::uint16_t>(first + n % odd_octets * 2 + n / odd_octets * 0x200);
}

int bluetooth_strength_dbm(double distance_m) {
  const radio::log_distance law;
  const auto loss_db =
      law.reference_db + 10 * law.exponent * math::log10(std::max(distance_m, 1.0));
  return static_cast<int>(std::lround(-loss_db));
}

peis_bluetooth_actor::behavior_type peis_bluetooth(bluetooth_pointer self,
                                                   config::peis_description network,
                                                   std::vector<config::bluetooth_device> others) {
  scheduler::tell_monitors_of_exceptions(self);
  self->set_down_handler([self](const caf::down_msg& x) { on_down(self, x); });
  self->state.network = network;
  for (const auto& each : others)
    self->state.adapters[each.address].place = each.place;
  return {
      [self](const join_bluetooth& x) { on_join(self, x); },
      [self](const scan_bluetooth& x) { on_scan(self, x); },
      [self](const send_hello& x) { on_hello(self, x); },
      [self](const bluetooth_connect& x) { on_connect(self, x); },
      [self](const lan_link_ended& x) { self->state.links.erase(x.link); },
      [self](const set_lan_power& x) { on_power(self, x); },
      [self](const move_machine& x) {
        for (auto& [address, each] : self->state.adapters) {
          if (each.machine == x.machine)
            each.place = x.place;
        }
        settle_links(self);
      },
  };
}

} // namespace rubicon
