#include "report/invariants.hpp"

#include <algorithm>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <utility>

namespace rubicon::report {

namespace {

violation at_end(const run_report& x, std::string invariant, std::string detail) {
  return {instant{} + x.simulated, std::move(invariant), std::move(detail)};
}

/// `name: left_text 10, right_text 9` when the two differ.
void check_equal(violations& found, const run_report& x, const char* invariant,
                 const std::string& name, std::pair<const char*, std::uint64_t> left,
                 std::pair<const char*, std::uint64_t> right) {
  if (left.second == right.second)
    return;
  found.push_back(at_end(x, invariant,
                         name + ": " + left.first + ' ' + std::to_string(left.second) + ", " +
                             right.first + ' ' + std::to_string(right.second)));
}

/// Each message that was offered was refused or sent, and each that was sent has arrived, is lost
/// for a known cause, or is in transit.
void check_offers(violations& found, const run_report& x, const std::string& name,
                  const message_report& messages) {
  constexpr const char* invariant = "one outcome per message";
  check_equal(found, x, invariant, name, {"offered", messages.offered},
              {"refused + sent",
               total(messages.refused) + messages.reliable_sent + messages.unreliable_sent});
  check_equal(found, x, invariant, name,
              {"sent", messages.reliable_sent + messages.unreliable_sent},
              {"arrived + lost + in transit",
               messages.arrived + total(messages.lost) + messages.in_transit});
  const auto unknown = messages.lost.find(std::string(to_string(loss::unknown)));
  if (unknown != messages.lost.end())
    check_equal(found, x, invariant, name, {"lost", unknown->second}, {"known why", 0});
}

bool contains(std::span<const mote_address> list, const mote_address& x) {
  return std::find(list.begin(), list.end(), x) != list.end();
}

template <class Id>
std::string text_of(const std::vector<Id>& ids) {
  std::string text;
  for (const auto id : ids)
    text += (text.empty() ? "" : " ") + to_string(id);
  return text;
}

/// The elements of `a` that `b` lacks, repetitions counted; both sorted.
template <class Id>
std::vector<Id> missing_from(const std::vector<Id>& b, const std::vector<Id>& a) {
  std::vector<Id> rest;
  std::set_difference(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(rest));
  return rest;
}

/// Who can reach whom over links, from what both ends say.
class reach_map {
public:
  explicit reach_map(std::span<const peer_view> peers) {
    for (const auto& peer : peers)
      neighbours_[peer.id]; // known, even without links
    for (const auto& peer : peers) {
      for (const auto other : peer.neighbours) {
        neighbours_[peer.id].insert(other);
        if (neighbours_.contains(other))
          neighbours_[other].insert(peer.id);
      }
    }
  }

  /// Ascending, `from` included; nothing if it can reach somebody who is no view.
  [[nodiscard]] std::optional<std::vector<peer_id>> of(peer_id from) const {
    std::set<peer_id> seen{from};
    std::vector<peer_id> open{from};
    while (!open.empty()) {
      const auto at = neighbours_.find(open.back());
      open.pop_back();
      if (at == neighbours_.end())
        return std::nullopt;
      for (const auto next : at->second) {
        if (seen.insert(next).second)
          open.push_back(next);
      }
    }
    return std::vector<peer_id>(seen.begin(), seen.end());
  }

private:
  std::map<peer_id, std::set<peer_id>> neighbours_;
};

void append(violations& all, violations part) {
  std::move(part.begin(), part.end(), std::back_inserter(all));
}

} // namespace

violations check_radio(const run_report& x) {
  violations found;
  for (const auto& island : x.islands) {
    const auto& radio = island.radio;
    check_equal(found, x, "radio copies balance", island.name, {"sent", radio.sent},
                {"delivered + lost", radio.delivered + total(radio.lost)});
    check_equal(
        found, x, "radio requests balance", island.name, {"requests", radio.requests},
        {"sent + failed + open", radio.mac_sent + total(radio.mac_failed) + radio.mac_open});
  }
  return found;
}

/// An event is received or lost, with a cause, or was in a frame that its receiver could not take.
violations check_groups(const run_report& x) {
  violations found;
  for (const auto& island : x.islands) {
    const auto& groups = island.smepp;
    if (groups.events_missing() > total(groups.refused))
      found.push_back(at_end(x, "events balance",
                             island.name + ": " + std::to_string(groups.events_missing()) +
                                 " events are missing, but only " +
                                 std::to_string(total(groups.refused)) + " frames were refused"));
  }
  return found;
}

violations check_real_lines(const run_report& x) {
  violations found;
  for (const auto& island : x.islands) {
    const auto& real = island.real;
    check_equal(found, x, "packets of real motes balance", island.name, {"came", real.packets},
                {"taken + dropped", real.taken + total(real.dropped)});
    check_equal(
        found, x, "inputs of real motes balance", island.name, {"asked", real.inputs},
        {"sent + failed + open", real.inputs_sent + total(real.inputs_failed) + real.inputs_open});
  }
  return found;
}

violations check_messages(const run_report& x) {
  violations found;
  for (const auto& island : x.islands) {
    const auto& messages = island.messages;
    check_equal(found, x, "reliable messages balance", island.name,
                {"sent", messages.reliable_sent},
                {"acked + failed + open",
                 messages.reliable_acked + messages.reliable_failed + messages.reliable_open});
    check_offers(found, x, island.name, messages);
    for (const auto& mote : island.motes)
      check_offers(found, x, island.name + '/' + mote.name, mote.messages);
  }
  check_offers(found, x, "PCs", x.pc_messages);
  return found;
}

violations check_flows(const run_report& x) {
  constexpr const char* invariant = "flow packets balance";
  violations found;
  for (const auto& flow : x.flows) {
    if (flow.to.mote == broadcast_mote)
      continue;
    const auto name = flow.from_name + " to " + flow.to_name;
    const auto ended = flow.delivered + total(flow.lost);
    if (ended > flow.sent)
      check_equal(found, x, invariant, name, {"sent", flow.sent}, {"delivered + lost", ended});
    else
      check_equal(found, x, invariant, name, {"sent", flow.sent},
                  {"delivered + lost + open", ended + flow.open});
  }
  return found;
}

violations check_energy(const run_report& x) {
  constexpr const char* invariant = "energy times sum to elapsed time";
  violations found;
  const auto ns = [](duration length) { return static_cast<std::uint64_t>(length.count()); };
  for (const auto& island : x.islands)
    for (const auto& mote : island.motes) {
      const auto name = island.name + '/' + mote.name;
      const auto& use = mote.energy;
      check_equal(found, x, invariant, name, {"elapsed ns", ns(use.elapsed)},
                  {"radio ns",
                   ns(use.radio_off + use.radio_listen + use.radio_receive + use.radio_transmit)});
      check_equal(found, x, invariant, name, {"elapsed ns", ns(use.elapsed)},
                  {"MCU ns", ns(use.mcu_active + use.mcu_sleep)});
    }
  return found;
}

violations check_actuations(const run_report& x) {
  violations found;
  for (const auto& proxy : x.proxies) {
    const auto outcomes =
        proxy.actuations.acknowledged + proxy.actuations.sent + total(proxy.actuations.failed);
    if (outcomes > proxy.actuations.requested)
      found.push_back(at_end(x, "one outcome per actuation",
                             proxy.name + ": requested " +
                                 std::to_string(proxy.actuations.requested) + ", outcomes " +
                                 std::to_string(outcomes)));
  }
  return found;
}

violations check_joined(const run_report& x, std::span<const mote_address> ended_by_fault) {
  violations found;
  for (const auto& island : x.islands)
    for (const auto& mote : island.motes) {
      const bool is_listed = mote.joined && mote.left_cause.empty();
      if (!mote.joins || is_listed || contains(ended_by_fault, mote.address))
        continue;
      const auto why = mote.joined ? "left: " + mote.left_cause : std::string("never joined");
      found.push_back(
          at_end(x, "every mote is joined", island.name + '/' + mote.name + ": " + why));
    }
  return found;
}

violations check_device_lists(const run_report& x, std::span<const device_list> lists) {
  violations found;
  for (const auto& list : lists) {
    auto expected = list.expected;
    auto actual = list.actual;
    std::sort(expected.begin(), expected.end());
    std::sort(actual.begin(), actual.end());
    if (expected == actual)
      continue;
    const auto absent = missing_from(actual, expected);
    const auto surplus = missing_from(expected, actual);
    auto detail = "island " + to_string(list.island) + ':';
    if (!absent.empty())
      detail += " not listed: " + text_of(absent);
    if (!surplus.empty())
      detail += (absent.empty() ? "" : ";") + std::string(" listed in error: ") + text_of(surplus);
    found.push_back(at_end(x, "the device list is true", std::move(detail)));
  }
  return found;
}

violations check_peers(const run_report& x, std::span<const peer_view> peers) {
  violations found;
  reach_map reach(peers);
  for (const auto& peer : peers) {
    const auto expected = reach.of(peer.id);
    auto actual = peer.hosts;
    std::sort(actual.begin(), actual.end());
    if (!expected || actual == *expected)
      continue;
    const auto absent = missing_from(actual, *expected);
    const auto surplus = missing_from(*expected, actual);
    auto detail = peer.name + ':';
    if (!absent.empty())
      detail += " does not know " + text_of(absent);
    if (!surplus.empty())
      detail += (absent.empty() ? "" : ";") + std::string(" cannot reach ") + text_of(surplus);
    found.push_back(at_end(x, "peers know whom they reach", std::move(detail)));
  }
  return found;
}

violations check_channels(const run_report& x, std::span<const channel_entry> all) {
  violations found;
  std::set<std::pair<mote_address, std::uint16_t>> begun;
  for (const auto& each : all)
    if (each.at == each.source)
      begun.emplace(each.source, each.number);
  for (const auto& each : all)
    if (!begun.contains({each.source, each.number}))
      found.push_back(at_end(x, "no channel is leaked",
                             "mote " + to_string(each.at) + " has channel " +
                                 std::to_string(each.number) + " of mote " +
                                 to_string(each.source) + ", which has no channel of that number"));
  return found;
}

violations check_streams(const run_report& x, std::span<const half_open_stream> all) {
  constexpr duration longest = 10min; // more than channels last without packets, and patience
  violations found;
  for (const auto& each : all)
    if (each.steady > longest)
      found.push_back(at_end(x, "no stream is half open",
                             "stream " + std::to_string(each.stream) + " is open at " +
                                 each.open_at + " and not at " + each.closed_at + " since " +
                                 rubicon::to_text(each.steady)));
  return found;
}

violations check_clocks(const run_report& x, std::span<const steady_island> islands) {
  violations found;
  for (const auto& island : x.islands) {
    const auto steady = std::ranges::find(islands, island.id, &steady_island::id);
    if (steady == islands.end())
      continue;
    const auto& network = island.network;
    if (!steady->sleeps && network.clock_error_max.value > clock_error_max)
      found.push_back(at_end(x, clocks_keep_their_bound,
                             island.name + ": a mote's island time is " +
                                 rubicon::to_text(network.clock_error_max.value) +
                                 " off, more than " + rubicon::to_text(clock_error_max)));
    if (network.clock_excess_max.value > clock_excess_max)
      found.push_back(at_end(x, clocks_keep_their_bound,
                             island.name + ": a mote's island time is " +
                                 rubicon::to_text(network.clock_excess_max.value) +
                                 " farther off than its error bound"));
  }
  return found;
}

violations check_ticks(const run_report& x, std::span<const steady_island> islands,
                       std::span<const peer_view> peers) {
  constexpr duration excess_max = 5ms;
  constexpr duration apart_max = 25ms; // packages over Bluetooth take as long one way at times
  constexpr const char* invariant = "ticks come together";
  violations found;
  for (const auto& island : x.islands) {
    const auto steady = std::ranges::find(islands, island.id, &steady_island::id);
    if (steady != islands.end() && steady->has_gateway &&
        island.network.time_excess_max.value > excess_max)
      found.push_back(at_end(x, invariant,
                             island.name + ": a mote's network time is " +
                                 rubicon::to_text(island.network.time_excess_max.value) +
                                 " farther off its gateway's than its error bound"));
  }
  std::map<peer_id, const peer_view*> by_id;
  for (const auto& peer : peers)
    by_id.emplace(peer.id, &peer);
  for (const auto& peer : peers) {
    for (const auto& id : peer.hosts) {
      const auto other = by_id.find(id);
      if (other == by_id.end() || peer.id >= id)
        continue;
      const auto apart = std::chrono::abs(peer.clock_offset - other->second->clock_offset);
      if (apart > apart_max)
        found.push_back(at_end(x, invariant,
                               "the network times of " + peer.name + " and " + other->second->name +
                                   " are " + rubicon::to_text(apart) + " apart"));
    }
  }
  return found;
}

violations check_timers(const run_report& x, std::uint64_t waiting) {
  constexpr std::uint64_t each_actor = 16;
  constexpr std::uint64_t beside = 1000;
  const auto bound = beside + each_actor * x.actors.spawned;
  if (waiting <= bound)
    return {};
  return {at_end(x, "no timer queue grows",
                 std::to_string(waiting) + " timeouts wait, more than " + std::to_string(bound))};
}

violations check_all(const run_report& x, const run_truth& truth) {
  auto all = check_radio(x);
  append(all, check_messages(x));
  append(all, check_real_lines(x));
  append(all, check_flows(x));
  append(all, check_groups(x));
  append(all, check_energy(x));
  append(all, check_actuations(x));
  append(all, check_joined(x, truth.ended_by_fault));
  append(all, check_device_lists(x, truth.device_lists));
  append(all, check_peers(x, truth.peers));
  append(all, check_channels(x, truth.channels));
  append(all, check_streams(x, truth.half_open));
  append(all, check_clocks(x, truth.steady_islands));
  append(all, check_ticks(x, truth.steady_islands, truth.peers));
  return all;
}

} // namespace rubicon::report
