#include "actors/peis_lan.hpp"

#include <algorithm>

#include "scheduler/supervision.hpp"

namespace rubicon {

namespace {

using lan_pointer = scheduler::traced_pointer<peis_lan_state, peis_lan_actor>;
using station = peis_lan_state::station;

bool separates(const peis_lan_state::fault& x, peer_id a, peer_id b) {
  const auto group = [&x](peer_id id) {
    const auto found = x.groups.find(id);
    return found == x.groups.end() ? x.rest : found->second;
  };
  return !x.groups.empty() && group(a) != group(b);
}

/// What the network does between two stations now.
link_condition condition_between(lan_pointer self, const station& a, const station& b) {
  link_condition x{!a.powered || !b.powered, 0};
  auto passing = 1 - self->state.network.loss;
  for (const auto& [name, fault] : self->state.faults) {
    x.cut = x.cut || separates(fault, a.id, b.id);
    if (fault.lossy.empty() || (fault.lossy.contains(a.id) && fault.lossy.contains(b.id)))
      passing *= 1 - fault.loss;
  }
  x.loss = 1 - passing;
  return x;
}

/// Tells the ends of all links what has changed for them: another condition, or that the process at
/// the far end is gone, if the computer there still says so.
void settle_links(lan_pointer self) {
  auto& state = self->state;
  for (auto i = state.links.begin(); i != state.links.end();) {
    auto& [number, link] = *i;
    const auto& a = state.stations.at(link.initiator);
    const auto& b = state.stations.at(link.acceptor);
    const auto x = condition_between(self, a, b);
    const bool ended = a.user == nullptr || b.user == nullptr;
    if (ended && !x.cut) {
      for (const auto* end : {&a, &b}) {
        if (end->user != nullptr)
          self->delayed_send(end->user, state.network.delay, link_closed{number});
      }
    } else if (!ended && (x.cut != link.condition.cut || x.loss != link.condition.loss)) {
      link.condition = x;
      self->send(a.user, condition_changed{number, x});
      self->send(b.user, condition_changed{number, x});
    }
    const bool forgotten = (ended && !x.cut) || (a.user == nullptr && b.user == nullptr);
    i = forgotten ? state.links.erase(i) : std::next(i);
  }
  std::erase_if(state.stations, [&state](const auto& x) {
    return x.second.user == nullptr && x.second.powered &&
           std::ranges::none_of(state.links, [&x](const auto& link) {
             return link.second.initiator == x.first || link.second.acceptor == x.first;
           });
  });
}

/// The station that `inproc://id` means to another: of two processes with one id the older.
std::map<std::uint64_t, station>::const_iterator find_listener(lan_pointer self, peer_id id,
                                                               std::uint64_t other) {
  const auto& stations = self->state.stations;
  return std::ranges::find_if(stations, [&](const auto& x) {
    return x.second.id == id && x.second.user != nullptr && x.first != other;
  });
}

/// Whether a computer where nobody listens can say so.
bool can_refuse(lan_pointer self, const station& from, peer_id id) {
  station nobody;
  nobody.id = id;
  nobody.powered = std::ranges::none_of(
      self->state.stations, [id](const auto& x) { return x.second.id == id && !x.second.powered; });
  return !condition_between(self, from, nobody).cut;
}

void on_connect(lan_pointer self, const lan_connect& x) {
  auto& state = self->state;
  const auto from = state.stations.find(x.station);
  if (from == state.stations.end() || from->second.user == nullptr)
    return;
  const auto to = find_listener(self, x.to, x.station);
  if (to == state.stations.end()) {
    if (can_refuse(self, from->second, x.to))
      self->delayed_send(from->second.user, state.network.delay, attempt_failed{x.attempt});
    return;
  }
  const auto condition = condition_between(self, from->second, to->second);
  if (condition.cut)
    return;
  const auto link = state.next_link++;
  state.links[link] = {from->first, to->first, condition};
  // The acceptor first: it must know the link before the initiator's first octets arrive.
  self->delayed_send(
      to->second.user, state.network.delay,
      link_opened{link, {caf::actor_cast<link_end_actor>(from->second.user)}, false, 0, condition});
  self->delayed_send(
      from->second.user, state.network.delay,
      link_opened{
          link, {caf::actor_cast<link_end_actor>(to->second.user)}, true, x.attempt, condition});
}

void on_announce(lan_pointer self, const lan_announce& x) {
  auto& state = self->state;
  const auto from = state.stations.find(x.station);
  if (from == state.stations.end())
    return;
  for (const auto& [number, other] : state.stations) {
    if (number == x.station || other.user == nullptr || !other.hears)
      continue;
    const auto condition = condition_between(self, from->second, other);
    if (!condition.cut && !state.rng.chance(condition.loss))
      self->delayed_send(other.user, state.network.delay, announcement{x.octets});
  }
}

void on_join(lan_pointer self, const join_lan& x) {
  self->monitor(x.user.actor);
  self->state.stations[x.station] = {x.id, x.user.actor, x.hears, true};
}

void on_down(lan_pointer self, const caf::down_msg& x) {
  for (auto& [number, each] : self->state.stations) {
    if (each.user != nullptr && each.user.address() == x.source)
      each.user = nullptr;
  }
  settle_links(self);
}

void on_power(lan_pointer self, const set_lan_power& x) {
  const auto found = self->state.stations.find(x.station);
  if (found == self->state.stations.end())
    return;
  found->second.powered = x.on;
  settle_links(self);
}

void on_fault(lan_pointer self, const begin_lan_fault& x) {
  auto& fault = self->state.faults[x.fault];
  fault.loss = x.loss;
  fault.rest = x.groups.size();
  for (std::size_t i = 0; i < x.groups.size(); ++i) {
    for (const auto id : x.groups[i])
      fault.groups[id] = i;
  }
  fault.lossy.insert(x.lossy.begin(), x.lossy.end());
  settle_links(self);
}

} // namespace

peis_lan_actor::behavior_type peis_lan(lan_pointer self, config::peis_description network,
                                       std::uint64_t seed) {
  scheduler::tell_monitors_of_exceptions(self);
  self->set_down_handler([self](const caf::down_msg& x) { on_down(self, x); });
  self->state.network = network;
  self->state.rng = random_stream(seed, self->path());
  return {
      [self](const join_lan& x) { on_join(self, x); },
      [self](const lan_connect& x) { on_connect(self, x); },
      [self](const lan_announce& x) { on_announce(self, x); },
      [self](const lan_link_ended& x) { self->state.links.erase(x.link); },
      [self](const set_lan_power& x) { on_power(self, x); },
      [self](const begin_lan_fault& x) { on_fault(self, x); },
      [self](const end_lan_fault& x) {
        self->state.faults.erase(x.fault);
        settle_links(self);
      },
  };
}

} // namespace rubicon
