#include "actors/supervision/run_truth.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "actors/island/mote.hpp"
#include "actors/island/sink.hpp"
#include "actors/supervision/supervised.hpp"

namespace rubicon {

namespace {

/// How long a change may take to reach the gateway's list: a mote is silent for three times as long
/// as it has promised, and as long again for a lost event to be repaired. Within it, at the end of
/// a run, list and truth may differ.
duration settling_time(const supervised_mote& mote) {
  return 2 * mote::keep_alives_max * mote.arguments->node.keep_alive + 30s;
}

/// Whether an island's gateway runs, and has done so for long enough to know its motes again. One
/// that leads among several has.
bool has_settled_gateway(ecology_pointer self, island_id island) {
  if (has_several_gateways(self, island))
    return std::ranges::any_of(island_of(self, island).gateways,
                               [](const auto& x) { return x.lead.leads; });
  const auto& peers = self->state.peers;
  const auto found =
      std::ranges::find_if(peers, [island](const auto& x) { return x.second.island == island; });
  return found != peers.end() && found->second.handle &&
         (found->second.incarnation == self->state.process.starts ||
          now(self) - found->second.changed >= 1min);
}

/// Whether nothing has happened for a while to any peer, nor to the network between them, nor to a
/// link to another process.
bool has_settled_peers(ecology_pointer self) {
  constexpr duration settling = 2min;
  const auto& state = self->state;
  auto last = std::max(state.last_lan_fault, state.last_outside_change);
  for (const auto& [name, peer] : state.peers)
    last = std::max(last, peer.changed);
  return state.duplicates.empty() && state.description.peis.loss == 0 &&
         now(self) - last >= settling;
}

std::vector<report::peer_view> views_of(ecology_pointer self) {
  std::vector<report::peer_view> views;
  const auto& state = self->state;
  for (const auto& [name, peer] : state.peers) {
    const auto view = state.peer_views.find(peer.id);
    if (peer.handle && view != state.peer_views.end())
      views.push_back(view->second);
  }
  return views;
}

/// Islands to whose motes something has happened for less than any channel lasts without packets.
std::set<island_id> stirred_islands(ecology_pointer self) {
  constexpr duration longest = 15min;
  const auto& state = self->state;
  std::set<island_id> found;
  for (const auto& [island, sink] : state.sinks)
    if (now(self) - sink.changed < longest)
      found.insert(island);
  for (const auto& [address, mote] : state.motes)
    if (now(self) - mote.changed < longest)
      found.insert(address.island);
  return found;
}

/// Whether no clock of an island was set, and its sink not started again, for longer than it takes
/// all its motes to believe it.
bool has_steady_clock(ecology_pointer self, island_id island) {
  constexpr duration longest = 15min; // two rounds, of which the second may be lost at some
  const auto& faults = self->state.last_clock_fault;
  const auto found = faults.find(island);
  return found == faults.end() || now(self) - found->second >= longest;
}

/// Over a slower line a question for the time and its answer may wait longer than the error that
/// is allowed.
constexpr std::uint32_t time_baud_min = 9600;

} // namespace

report::run_truth truth_of(ecology_pointer self) {
  const auto& state = self->state;
  report::run_truth truth;
  std::map<island_id, report::device_list> lists;
  std::set<island_id> elsewhere; // their gateways are other programs', which alone know
  for (const auto& island : state.description.islands)
    if (island.outside.has_gateway())
      elsewhere.insert(island.id);
  for (const auto& [address, mote] : state.motes) {
    if (mote.arguments->stack != config::stack::full)
      continue; // no gateway lists it
    if (elsewhere.contains(address.island)) {
      truth.ended_by_fault.push_back(address);
      continue;
    }
    auto& list = lists[address.island];
    list.island = address.island;
    const auto& sink = state.sinks.at(address.island);
    const bool settled = now(self) - std::max(mote.changed, sink.changed) >= settling_time(mote);
    const auto reported = state.listed.find(address.island);
    const bool listed = reported != state.listed.end() &&
                        std::ranges::find(reported->second, address.mote) != reported->second.end();
    if (listed)
      list.actual.push_back(address.mote);
    const bool runs = !mote.flat && mote.handle && sink.handle;
    if (settled ? runs : listed)
      list.expected.push_back(address.mote);
    if (!runs || !settled)
      truth.ended_by_fault.push_back(address);
  }
  for (const auto& [address, since] : state.gone) {
    const auto reported = state.listed.find(address.island);
    const bool listed = reported != state.listed.end() &&
                        std::ranges::find(reported->second, address.mote) != reported->second.end();
    if (!listed || now(self) - since < settling_time(mote_now(self, address)))
      continue;
    auto& list = lists[address.island];
    list.island = address.island;
    list.actual.push_back(address.mote);
    std::ranges::sort(list.actual);
  }
  for (auto& [island, list] : lists) {
    if (has_settled_gateway(self, island))
      truth.device_lists.push_back(std::move(list));
  }
  if (has_settled_peers(self))
    truth.peers = views_of(self);
  truth.half_open = state.counters.half_open(now(self));
  const auto stirred = stirred_islands(self);
  for (const auto& [address, table] : state.channel_tables)
    if (!stirred.contains(address.island))
      for (const auto& id : table)
        truth.channels.push_back({address, {address.island, id.source}, id.number});
  // In wall time a mote reads its clock when the computer comes to it.
  const bool is_exact = state.description.mode == config::run_mode::virtual_time;
  for (const auto& island : state.description.islands)
    if (is_exact && has_steady_clock(self, island.id))
      truth.steady_islands.push_back({island.id, island.duty.enabled,
                                      island.serial.baud >= time_baud_min &&
                                          has_settled_gateway(self, island.id) &&
                                          has_settled_peers(self)});
  return truth;
}

} // namespace rubicon
