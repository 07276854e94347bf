#include "actors/supervision/ecology.hpp"

#include <algorithm>
#include <utility>

#include "actors/base/failure.hpp"
#include "actors/base/log.hpp"
#include "actors/island/mote.hpp"
#include "actors/island/program.hpp"
#include "actors/island/sink.hpp"
#include "actors/messages/air.hpp"
#include "actors/messages/common.hpp"
#include "actors/messages/programs.hpp"
#include "actors/messages/serial.hpp"
#include "actors/messages/supervision.hpp"
#include "actors/supervision/assembly.hpp"
#include "actors/supervision/changes.hpp"
#include "actors/supervision/fault_plan.hpp"
#include "actors/supervision/peer_supervision.hpp"
#include "actors/supervision/report_collection.hpp"
#include "actors/supervision/supervised.hpp"
#include "config/plan/debug_selection.hpp"

namespace rubicon {

namespace {

/// A mote, a sink, or a program beside a mote, that failed on its own is out of order for this long
/// before it starts again.
constexpr duration reboot_time = 500ms;

/// What the fault plan has asked for, if this is it.
std::optional<planned_end> take_planned(ecology_pointer self, const std::string& path,
                                        const std::string& text) {
  auto& requested = self->state.planned_ends;
  const auto found = std::ranges::find(requested, path, &planned_end::path);
  if (text != planned_crash || found == requested.end())
    return std::nullopt;
  auto plan = std::move(*found);
  std::erase_if(requested, [&path](const auto& x) { return x.path == path; }); // it ends once
  return plan;
}

void on_unmet(ecology_pointer self, const request_unmet& x) {
  const auto what = x.who + ": " + x.what;
  log(self, spdlog::level::err, "event=unmet what=\"{}\"", what);
  note_event(self, x.who, x.what);
  add_violation(self, report::requests_are_met, what);
  if (x.ends_run && self->state.process.on_end_wanted)
    self->state.process.on_end_wanted(what);
}

/// Records how a mote or sink has ended. @returns the fault that has asked for it
std::optional<planned_end> note_end(ecology_pointer self, const std::string& path,
                                    const std::string& who, const caf::error& reason) {
  const auto text = text_of(reason);
  auto plan = take_planned(self, path, text);
  if (!plan) {
    record_failure(self, path, text);
    note_event(self, who, "crashed: " + text);
    return plan;
  }
  const auto* how = plan->fault < self->state.planned_faults ? "as planned" : "by hand";
  log(self, spdlog::level::info, "event=crashed actor={} how=\"{}\"", path, how);
  const bool is_long = plan->length != reboot_time;
  note_event(self, who,
             std::string("crashed ") + how + (is_long ? ", out for " + to_text(plan->length) : ""));
  return plan;
}

duration outage(const std::optional<planned_end>& x) {
  return x ? x->length : reboot_time;
}

/// A mote that is carried to another island: it will be one of that island, and knows itself again.
void carry(ecology_pointer self, mote_address from, const planned_end& plan) {
  auto& state = self->state;
  const auto next = state.successors.at(plan.fault);
  auto entry = state.motes.extract(from);
  auto& mote = entry.mapped();
  state.moved[from] = {next->address, mote.arguments->name};
  self->send(mote.arguments->air, carry_away{mote.arguments->radio});
  mote.arguments = next;
  mote.in_transit = true;
  mote.last_listing.reset();
  entry.key() = next->address;
  state.motes.insert(std::move(entry));
  state.gone[from] = now(self);
  self->delayed_send(self, plan.length, restart_mote{next->address});
}

void on_mote_down(ecology_pointer self, supervised_mote& mote, const caf::error& reason) {
  auto& state = self->state;
  const auto path = "mote/" + mote.arguments->name;
  mote.handle = nullptr;
  mote.changed = now(self);
  const auto text = text_of(reason);
  const auto planned = std::ranges::find(state.planned_ends, path, &planned_end::path);
  if (text == planned_crash && planned != state.planned_ends.end() &&
      std::holds_alternative<config::move_island_fault>(
          state.description.faults.at(planned->fault).what)) {
    const auto plan = *take_planned(self, path, text);
    const auto& to = state.successors.at(plan.fault)->name;
    note_event(self, path, "carried away, to be " + to + " in " + to_text(plan.length));
    carry(self, mote.arguments->address, plan);
    return;
  }
  const auto plan = note_end(self, path, path, reason);
  self->send(mote.arguments->air, radio_power{mote.arguments->radio, radio::power::off});
  if (mote.arguments->backbone)
    self->send(mote.arguments->backbone, attach_backbone{true, {}});
  const auto next = plan ? state.successors.find(plan->fault) : state.successors.end();
  if (next != state.successors.end() && next->second->address == mote.arguments->address) {
    const auto& crash =
        std::get<config::crash_fault>(state.description.faults.at(plan->fault).what);
    mote.arguments = next->second; // one that was carried away keeps its type
    mote.type = crash.type;
  }
  self->delayed_send(self, outage(plan), restart_mote{mote.arguments->address});
}

/// Its end of the serial cables is dead, too.
void on_sink_down(ecology_pointer self, island_id island, supervised_sink& sink,
                  const caf::error& reason) {
  auto& state = self->state;
  state.names.erase(sink.handle.address());
  std::erase_if(state.reporters,
                [&sink](const auto& each) { return each.first == sink.handle.address(); });
  sink.handle = nullptr;
  sink.changed = now(self);
  self->send(sink.arguments->air, radio_power{sink.arguments->radio, radio::power::off});
  for (const auto& each : sink.arguments->lines)
    self->send(each.line, attach_serial{serial::direction::to_mote, {}});
  for (const auto& each : sink.arguments->backbones)
    self->send(each.link, attach_backbone{false, {}});
  self->delayed_send(self, outage(note_end(self, sink.path, event_source(sink), reason)),
                     restart_sink{island});
}

void restart(ecology_pointer self, const restart_sink& x) {
  auto& sink = self->state.sinks.at(x.island);
  self->state.last_clock_fault[x.island] = now(self);
  spawn_sink(self, sink);
  note_event(self, event_source(sink),
             "started again, life " + std::to_string(sink.store.starts + 1));
}

/// @returns whether it was a program in an actor of its own
bool on_program_down(ecology_pointer self, const caf::down_msg& x) {
  auto& state = self->state;
  for (auto& [address, mote] : state.motes) {
    for (auto& program : mote.programs) {
      if (!program.handle || program.handle.address() != x.source)
        continue;
      record_failure(self, program.path, text_of(x.reason));
      note_event(self, program.path, "crashed: " + text_of(x.reason));
      program.handle = nullptr;
      state.names.erase(x.source);
      std::erase_if(state.reporters, [&x](const auto& each) { return each.first == x.source; });
      ++program.incarnation;
      self->delayed_send(
          self, reboot_time,
          restart_program{address, static_cast<std::uint32_t>(program.arguments->number)});
      return true;
    }
  }
  return false;
}

void restart(ecology_pointer self, const restart_program& x) {
  auto& mote = self->state.motes.at(x.mote);
  const auto found = std::ranges::find_if(
      mote.programs, [&x](const auto& each) { return each.arguments->number == x.number; });
  ++self->state.report.actors.restarted;
  spawn_program(self, mote, *found);
}

void on_down(ecology_pointer self, const caf::down_msg& x) {
  auto& motes = self->state.motes;
  const auto mote = std::ranges::find_if(motes, [&](const auto& entry) {
    return entry.second.handle && entry.second.handle.address() == x.source;
  });
  if (mote != motes.end()) {
    on_mote_down(self, mote->second, x.reason);
    return;
  }
  if (on_program_down(self, x) || on_double_down(self, x))
    return;
  const auto sink = std::ranges::find_if(self->state.sinks, [&](const auto& entry) {
    return entry.second.handle && entry.second.handle.address() == x.source;
  });
  if (sink != self->state.sinks.end()) {
    on_sink_down(self, sink->first, sink->second, x.reason);
    return;
  }
  const auto named = self->state.names.find(x.source);
  if (named == self->state.names.end())
    return;
  static_cast<void>(on_kernel_down(self, x.source));
  on_init_down(self, x.source);
  if (!was_asked_to_end(x.reason))
    record_failure(self, named->second, text_of(x.reason));
  note_event(self, named->second, "ended");
}

/// A real mote has joined its island, or left it; the file may have a name for it.
void on_real_listing(ecology_pointer self, const config::island_description& island,
                     const listing_changed& x) {
  auto name = "mote-" + to_string(x.mote.mote);
  for (const auto& mote : island.motes)
    if (mote.id == x.mote.mote)
      name = mote.name;
  for (const auto& [id, known] : island.real.names)
    if (id == x.mote.mote)
      name = known;
  note_event(self, "mote/" + island.name + '/' + name,
             x.listed ? "joined" : "left: " + network::to_string(x.cause));
  if (auto* judge = self->state.process.judge; judge != nullptr && x.listed)
    judge->on_joined(x.mote, now(self));
}

/// A mote that has left because its battery ends, or by its own request, is not missed.
bool has_left_by_itself(network::leave_cause x) {
  return x == network::leave_cause::notice || x == network::leave_cause::battery;
}

void on_listing(ecology_pointer self, const listing_changed& x) {
  const auto& island = *std::ranges::find(self->state.description.islands, x.mote.island,
                                          &config::island_description::id);
  if (config::has_plain_sink(island) ||
      (island.real.is_there() && island.real.motes.has(x.mote.mote))) {
    on_real_listing(self, island, x);
    return;
  }
  const auto found = self->state.motes.find(x.mote);
  if (found == self->state.motes.end()) {
    const auto moved = self->state.moved.find(x.mote);
    if (moved == self->state.moved.end())
      note_event(self, "mote/" + to_string(x.mote), "an unknown mote has joined");
    else if (!x.listed)
      note_event(self, "mote/" + mote_now(self, x.mote).arguments->name,
                 "left " + island_of(self, x.mote.island).name + ": " +
                     network::to_string(x.cause));
    return;
  }
  auto& mote = found->second;
  const std::pair news{x.listed, x.incarnation};
  if (has_several_gateways(self, x.mote.island) && mote.last_listing == news)
    return; // another gateway has reported it
  mote.last_listing = news;
  mote.changed = now(self);
  self->state.watch.on_listed(x.mote, x.listed, has_left_by_itself(x.cause), now(self));
  if (!x.listed) {
    mote.left_cause = network::to_string(x.cause);
    note_event(self, "mote/" + mote.arguments->name, "left: " + mote.left_cause);
    return;
  }
  const bool again = mote.joined;
  mote.joined = true;
  if (auto* judge = self->state.process.judge)
    judge->on_joined(x.mote, now(self));
  mote.left_cause.clear();
  note_event(self, "mote/" + mote.arguments->name,
             again ? "joined again, life " + std::to_string(x.incarnation + 1) : "joined");
}

void on_store(ecology_pointer self, const store_written& x) {
  if (auto* second = double_of_sender(self)) {
    second->store = x.content;
    return;
  }
  note_starts(self, std::max(x.content.starts, x.content.term));
  auto& motes = self->state.motes;
  if (const auto mote = motes.find(x.mote); mote != motes.end())
    mote->second.store = x.content;
  else if (const auto sink = self->state.sinks.find(x.mote.island); sink != self->state.sinks.end())
    sink->second.store = x.content; // that of an island that only measures starts once
}

/// Of a second mote only what its Network has counted is a part of the island's.
bool on_double_network(ecology_pointer self, network_status x) {
  if (double_of_sender(self) == nullptr)
    return false;
  x.network.synchronised = x.network.aligned = x.network.hops_max = 0;
  island_of(self, x.address.island).network += x.network;
  return true;
}

/// A mote comes to another island with the battery that it has.
void on_radio_left(ecology_pointer self, const radio_left& x) {
  mote_now(self, x.used.mote).used_mah = x.used.energy.used_mah;
}

void restart(ecology_pointer self, const restart_mote& x) {
  auto& mote = self->state.motes.at(x.mote);
  if (mote.flat)
    return;
  if (std::exchange(mote.in_transit, false))
    self->send(mote.arguments->air, bring_radio{mote.arguments->radio, mote.used_mah});
  spawn_mote(self, mote);
}

/// Islands whose sink and gateway are ours.
void watch_islands(ecology_pointer self) {
  auto& state = self->state;
  for (const auto& island : state.description.islands) {
    if (island.stack != config::stack::full || island.outside.has_sink() ||
        island.outside.has_gateway())
      continue;
    report::healing_rules rules;
    rules.sleeps = island.duty.enabled || island.listening.enabled();
    rules.period = island.duty.enabled ? island.duty.period : silence_max(island) / 4;
    rules.departure = silence_max(island);
    rules.judges = state.description.mode == config::run_mode::virtual_time;
    state.watch.add_island(island.id, island.name, rules);
  }
}

} // namespace

root_actor::behavior_type ecology(ecology_pointer self, config::ecology_description description,
                                  report_receiver on_report, frame_observer observe_frames,
                                  process_facts process) {
  self->state.description = std::move(description);
  self->state.on_report = std::move(on_report);
  self->state.observe_frames = std::move(observe_frames);
  self->set_down_handler([self](const caf::down_msg& x) { on_down(self, x); });
  self->state.process = std::move(process);
  self->state.messages = self->ledger();
  self->state.plan = report::plan_faults(self->state.description);
  self->state.planned_faults = self->state.description.faults.size();
  self->state.most_starts = self->state.process.starts;
  self->state.rng = random_stream(self->state.description.seed, self->path() + "/faults");
  prepare_report(self);
  watch_islands(self);
  assemble(self);
  for (auto& island : self->state.description.islands)
    if (!config::has_plain_sink(island)) // names of plain motes are asked for again
      island.motes = std::vector<config::mote_description>(); // `= {}` would keep its memory
  schedule_fault(self);
  schedule_sample(self);
  return {
      [self](const notable_event& x) { note_event(self, x.who, x.what); },
      [self](const actor_failed& x) { record_failure(self, x.who, x.why); },
      [self](const request_unmet& x) { on_unmet(self, x); },
      [self](const store_written& x) { on_store(self, x); },
      [self](const radio_left& x) { on_radio_left(self, x); },
      [self](const mote_flat& x) {
        if (double_of_sender(self) == nullptr)
          on_flat(self, self->state.motes.at(x.mote));
      },
      [self](const listing_changed& x) { on_listing(self, x); },
      [self](const radio_status& x) { island_of(self, x.island).radio += x.radio; },
      [self](const energy_status& x) { on_energy(self, x); },
      [self](const flow_status& x) {
        for (const auto& part : x.parts)
          self->state.flows[{part.from, part.to}] += part;
      },
      [self](const message_status& x) { self->state.counters.add(x.who, x.is_pc, x.messages); },
      [self](const network_status& x) {
        if (!on_double_network(self, x))
          on_network(self, x);
      },
      [self](const smepp_status& x) {
        if (double_of_sender(self) == nullptr) // which speaks for no member
          island_of(self, x.island).smepp += x.smepp;
      },
      [self](const serial_status& x) { island_of(self, x.island).serial += x.serial; },
      [self](const backbone_status& x) {
        island_of(self, x.island).network.backbone += x.backbone;
      },
      [self](const real_line_status& x) { island_of(self, x.island).real += x.real; },
      [self](const devices_status& x) {
        self->state.listed[x.island] = x.listed;
        if (x.has_clock)
          self->state.clocks[x.island].clock_offset = x.clock_offset;
      },
      [self](const gateway_status& x) { on_lead(self, x); },
      [self](const peer_status& x) {
        self->state.report.peers.push_back(x.peer);
        self->state.peer_views[x.peer.id] = {x.peer.id, x.peer.name, x.hosts, x.neighbours,
                                             x.clock_offset};
      },
      [self](const proxy_status& x) { self->state.counters.add(x.proxy, x.ended); },
      [self](const program_status& x) { on_program(self, x); },
      [self](const module_status& x) { self->state.counters.add(x.peer, x.counters); },
      [self](const sample_status& x) { on_sample(self, x); },
      [self](take_sample) { on_take_sample(self); },
      [self](const apply_fault& x) { apply(self, x); },
      [self](const restart_mote& x) { restart(self, x); },
      [self](const restart_sink& x) { restart(self, x); },
      [self](const end_fault& x) { end_double(self, x.index); },
      [self](const restart_program& x) { restart(self, x); },
      [self](const restart_peer& x) { restart(self, self->state.peers.at(x.name)); },
      [self](const end_duplicate& x) { end_duplicate_peer(self, x.name); },
      [self](const debug_wanted& x) { select_debug(self, x.who, config::debug_patterns(x.text)); },
      [self](outside_link_changed) { self->state.last_outside_change = now(self); },
      [self](const start_component& x) { start_component_peer(self, x); },
      [self](const stop_component& x) { stop_component_peer(self, x); },
      [self](end_run) { end_peers(self); },
      [self](collect_report) { begin_collecting(self); },
      [self](deliver_report) { deliver(self); },
  };
}

} // namespace rubicon
