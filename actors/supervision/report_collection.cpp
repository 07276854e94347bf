#include "actors/supervision/report_collection.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "actors/island/mote.hpp"
#include "actors/messages/programs.hpp"
#include "actors/supervision/run_truth.hpp"
#include "actors/supervision/supervised.hpp"

namespace rubicon {

namespace {

/// The same of a node of another host; empty if it is of none.
std::string name_elsewhere(const config::part_description& part, const mote_address& x) {
  const auto island = std::ranges::find(part.others, x.island, &config::island_description::id);
  if (island != part.others.end()) {
    const auto mote = std::ranges::find(island->motes, x.mote, &config::mote_description::id);
    return x.mote == no_mote             ? island->gateway_name
           : mote == island->motes.end() ? std::string()
                                         : island->name + '/' + mote->name;
  }
  const auto peer = part.other_peers.find(peer_id{static_cast<std::int32_t>(x.island.value)});
  return x.mote == no_mote && peer != part.other_peers.end() ? peer->second : std::string();
}

/// `kitchen/fan`, also of a mote that was carried away from there, or the name of a peer.
std::string node_name(ecology_pointer self, const mote_address& x) {
  const auto& state = self->state;
  if (const auto mote = state.motes.find(x); mote != state.motes.end())
    return mote->second.arguments->name;
  if (const auto moved = state.moved.find(x); moved != state.moved.end())
    return moved->second.former_name;
  if (state.description.part)
    if (auto name = name_elsewhere(*state.description.part, x); !name.empty())
      return name;
  const auto peer = std::ranges::find_if(state.peers, [&x](const auto& each) {
    return each.second.id.value == static_cast<std::int32_t>(x.island.value);
  });
  return x.mote == no_mote && peer != state.peers.end() ? peer->first : to_string(x);
}

void compare(ecology_pointer self, const mote_address& mote, std::int64_t apart_us) {
  self->state.process.judge->on_clock(mote, node_name(self, mote),
                                      std::chrono::microseconds(std::abs(apart_us)), now(self));
}

void compare_clocks(ecology_pointer self) {
  const auto compare_all = [](const std::vector<known_time>& all, duration truth,
                              largest<duration>& error, largest<duration>& excess) {
    for (const auto& x : all) {
      const auto apart = std::chrono::abs(x.ahead - truth);
      error = std::max(error.value, apart);
      excess = std::max(excess.value, apart - x.doubt);
    }
  };
  for (const auto& [island, clocks] : self->state.clocks) {
    auto& network = island_of(self, island).network;
    if (clocks.sink_ahead)
      compare_all(clocks.motes, *clocks.sink_ahead, network.clock_error_max,
                  network.clock_excess_max);
    if (clocks.clock_offset)
      compare_all(clocks.network, *clocks.clock_offset, network.time_error_max,
                  network.time_excess_max);
  }
}

/// `lab/sink`, `lab/mote-7`, `lab/*`
std::string mote_name(ecology_pointer self, const mote_address& x) {
  const auto island = island_of(self, x.island).name;
  if (x.mote == broadcast_mote)
    return island + "/*";
  const auto found = self->state.motes.find(x);
  return found == self->state.motes.end() ? island + "/sink" : found->second.arguments->name;
}

/// nullptr: it is none of the motes. begin_collecting() has made them in the order of addresses,
/// and an island may have thousands, each of which is looked for several times.
report::mote_report* report_of(report::island_report& island, const mote_address& x) {
  const auto found = std::ranges::lower_bound(island.motes, x, {}, &report::mote_report::address);
  return found != island.motes.end() && found->address == x ? &*found : nullptr;
}

report::flow_report report_of(ecology_pointer self, const traffic::part& x) {
  report::flow_report r;
  r.from = x.from;
  r.to = x.to;
  r.from_name = mote_name(self, x.from);
  r.to_name = mote_name(self, x.to);
  r.sent = x.sent;
  r.delivered = x.delivered;
  r.lost = x.lost;
  r.delay_mean_ms = x.delay.mean_ms();
  r.delay_p50_ms = x.delay.quantile_ms(0.5);
  r.delay_p95_ms = x.delay.quantile_ms(0.95);
  if (x.active > 0s)
    r.goodput_bps = 8 * static_cast<double>(x.octets) / seconds(x.active);
  if (x.sent > 0) {
    r.pdr = static_cast<double>(x.delivered) / static_cast<double>(x.sent);
    r.tx_per_packet = static_cast<double>(x.transmissions) / static_cast<double>(x.sent);
  }
  const auto ended = x.delivered + report::total(x.lost);
  r.open = x.to.mote != broadcast_mote && ended < x.sent ? x.sent - ended : 0;
  return r;
}

} // namespace

void on_network(ecology_pointer self, const network_status& x) {
  auto& island = island_of(self, x.address.island);
  island.network += x.network;
  auto* const mote = report_of(island, x.address);
  if (mote != nullptr) {
    mote->parent = x.parent;
    mote->hops = x.hops;
    if (x.has_signal && x.parent != mote_id{})
      mote->signal_dbm = x.signal_dbm;
  }
  if (x.is_sink || (mote != nullptr && mote->alive))
    self->state.channel_tables[x.address] = x.channels;
  if (!x.has_clock)
    return;
  auto& clocks = self->state.clocks[x.address.island];
  const std::chrono::microseconds doubt(x.clock_doubt_us);
  if (x.has_network_time)
    clocks.network.push_back({std::chrono::microseconds(x.network_ahead_us), doubt});
  const std::chrono::microseconds ahead(x.clock_ahead_us);
  if (x.is_sink)
    clocks.sink_ahead = ahead;
  else
    clocks.motes.push_back({ahead, doubt});
}

void on_program(ecology_pointer self, const program_status& x) {
  std::vector<report::stream_part> parts;
  for (const auto& end : x.streams)
    parts.push_back({end, end.writes ? x.program.who : std::string(),
                     end.writes ? node_name(self, end.reader) : x.program.who});
  self->state.counters.add(x.program, x.number, x.measured, parts);
}

void schedule_sample(ecology_pointer self) {
  const auto* judge = self->state.process.judge;
  const auto next = judge == nullptr ? std::nullopt : judge->next_sample();
  if (next)
    self->scheduled_send(self, *next, take_sample{});
}

void on_take_sample(ecology_pointer self) {
  auto& state = self->state;
  if (state.ending || state.process.judge == nullptr)
    return;
  const status_request request{++state.samples};
  for (const auto& [address, mote] : state.motes)
    if (mote.handle)
      self->send(mote.handle, request);
  for (const auto& [who, ask] : state.reporters) {
    const auto name = state.names.find(who);
    const auto answers = [&name](std::string_view kind) { return name->second.starts_with(kind); };
    if (name != state.names.end() &&
        (answers("sink/") || answers("pc/") || answers("gateway/") || answers("program/")))
      ask(request);
  }
  state.process.judge->on_sample(now(self));
  schedule_sample(self);
}

void on_sample(ecology_pointer self, const sample_status& x) {
  auto& state = self->state;
  if (state.process.judge == nullptr)
    return;
  for (const auto& [number, missed] : x.missed)
    state.process.judge->on_vectors(
        x.who, number, missed + state.counters.vectors_missed(x.who, number), now(self));
  if (!x.has_address || !x.has_clock)
    return;
  auto& samples = state.sampled[x.address.island];
  if (samples.number != x.sample)
    samples = {x.sample, std::nullopt, {}};
  if (!x.is_sink) {
    if (samples.sink_ahead_us)
      compare(self, x.address, x.clock_ahead_us - *samples.sink_ahead_us);
    else
      samples.waiting.emplace_back(x.address, x.clock_ahead_us);
    return;
  }
  samples.sink_ahead_us = x.clock_ahead_us;
  for (const auto& [mote, ahead] : std::exchange(samples.waiting, {}))
    compare(self, mote, ahead - x.clock_ahead_us);
}

void on_lead(ecology_pointer self, const gateway_status& x) {
  auto& all = island_of(self, x.island).gateways;
  const auto found = std::ranges::find(all, x.gateway, &report::gateway_report::id);
  if (found != all.end())
    found->lead += x.lead;
}

void prepare_report(ecology_pointer self) {
  auto& state = self->state;
  state.report.ecology = state.description.name;
  state.report.seed = state.description.seed;
  for (const auto& island : state.description.islands) {
    report::island_report x;
    x.id = island.id;
    x.name = island.name;
    if (!island.aliases.empty())
      x.gateways.push_back({gateway_of(island.id), island.gateway_name, {}});
    for (const auto& alias : island.aliases)
      x.gateways.push_back({alias.id, alias.name, {}});
    state.report.islands.push_back(std::move(x));
  }
}

void begin_collecting(ecology_pointer self) {
  auto& state = self->state;
  for (const auto& [address, mote] : state.motes) {
    report::mote_report x;
    x.address = address;
    x.name = mote.arguments->name.substr(mote.arguments->name.find('/') + 1);
    x.type = mote.type;
    x.further_sink = static_cast<bool>(mote.arguments->backbone);
    x.joins = mote.arguments->stack == config::stack::full;
    x.joined = mote.joined;
    x.alive = !mote.flat && mote.handle != nullptr;
    x.incarnations = mote.store.starts;
    x.left_cause = mote.left_cause;
    island_of(self, address.island).motes.push_back(std::move(x));
    if (mote.handle)
      self->send(mote.handle, status_request{});
  }
  for (const auto& [name, peer] : state.peers) {
    if (!peer.handle) {
      report::peer_report x;
      x.id = peer.id;
      x.name = name;
      x.alive = false;
      x.incarnations = peer.begun ? peer.incarnation + 1 : 0;
      state.report.peers.push_back(std::move(x));
    }
  }
  for (const auto& [who, ask] : state.reporters)
    ask(status_request{});
}

void on_energy(ecology_pointer self, const energy_status& x) {
  if (auto* const mote = report_of(island_of(self, x.mote.island), x.mote))
    mote->energy = x.energy; // else a sink: it lives on its cable
}

void deliver(ecology_pointer self) {
  auto& report = self->state.report;
  for (const auto& [ends, part] : self->state.flows)
    report.flows.push_back(report_of(self, part));
  compare_clocks(self);
  report.simulated = now(self).time_since_epoch();
  std::ranges::sort(report.peers, {}, &report::peer_report::id);
  self->state.counters.take(*self->state.messages);
  if (self->state.process.on_counters)
    self->state.process.on_counters(self->state.counters);
  self->state.counters.settle(report);
  self->state.watch.fill(report, now(self));
  for (auto& x : report::check_all(report, truth_of(self)))
    report.violations.push_back(std::move(x));
  if (report.islands.empty() && report.peers.empty())
    add_violation(self, report::requests_are_met, "there is no island and no peer: nothing ran");
  report.complete = true;
  self->state.delivered = true;
  self->state.on_report(report); // still ours: programs that end later send their counters
}

} // namespace rubicon
