#include "actors/ecology.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <type_traits>
#include <utility>

#include "actors/assembly.hpp"
#include "actors/changes.hpp"
#include "actors/failure.hpp"
#include "actors/log.hpp"
#include "actors/messages/air.hpp"
#include "actors/messages/common.hpp"
#include "actors/messages/programs.hpp"
#include "actors/messages/serial.hpp"
#include "actors/messages/supervision.hpp"
#include "actors/mote.hpp"
#include "actors/peer_supervision.hpp"
#include "actors/program.hpp"
#include "actors/sink.hpp"
#include "config/debug_selection.hpp"
#include "report/event_log.hpp"

namespace rubicon {

void note_event(ecology_pointer self, const std::string& who, std::string what) {
  auto& report = self->state.report;
  log(self, spdlog::level::info, "event=noted who={} what=\"{}\"", who, what);
  self->remark("event", 0, [&] { return to_bytes(who + '\t' + what); });
  report::logged_event event{now(self), who.substr(who.find('/') + 1), std::move(what)};
  if (self->state.process.on_event)
    self->state.process.on_event(event);
  if (self->state.process.judge != nullptr)
    self->state.process.judge->on_event(event);
  report::add_event(report.event_log, report.event_log_left_out, std::move(event));
}

supervised_mote& mote_now(ecology_pointer self, mote_address x) {
  const auto& all = self->state.moved;
  for (auto moved = all.find(x); moved != all.end(); moved = all.find(x))
    x = moved->second;
  return self->state.motes.at(x);
}

namespace {

/// A mote, a sink, or a program beside a mote, that failed on its own is out of order for this long
/// before it starts again.
constexpr duration reboot_time = 500ms;

/// How long a change may take to reach the gateway's list: a mote is silent for three times as long
/// as it has promised, and as long again for a lost event to be repaired. Within it, at the end of
/// a run, list and truth may differ.
duration settling_time(const supervised_mote& mote) {
  return 2 * mote::keep_alives_max * mote.arguments->node.keep_alive + 30s;
}

/// Takes a violation into the report, or tells it behind the report that is already out.
void add_violation(ecology_pointer self, const char* invariant, std::string detail) {
  auto& state = self->state;
  report::violation x{now(self), invariant, std::move(detail)};
  constexpr std::size_t violations_max = 1000;
  if (state.delivered && state.process.on_late_violation)
    state.process.on_late_violation(std::move(x));
  else if (state.report.violations.size() < violations_max)
    state.report.violations.push_back(std::move(x));
}

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

void record_failure(ecology_pointer self, const std::string& path, const std::string& text) {
  log(self, spdlog::level::err, "event=failed actor={} reason=\"{}\"", path, text);
  add_violation(self, report::no_actor_fails, path + ": " + text);
  auto& failures = self->state.report.actors.failures;
  constexpr std::size_t failures_max = 100;
  if (failures.size() < failures_max)
    failures.push_back(path + ": " + text);
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
  self->send(mote.arguments->air, carry_away{mote.arguments->radio});
  mote.arguments = next;
  mote.in_transit = true;
  mote.told.reset();
  entry.key() = next->address;
  state.motes.insert(std::move(entry));
  state.moved[from] = next->address;
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

/// An event says `kitchen/sink`.
std::string event_source(const supervised_sink& x) {
  return x.path + "/sink";
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

bool on_double_down(ecology_pointer self, const caf::down_msg& x);

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

report::island_report& island_of(ecology_pointer self, island_id id) {
  return *std::ranges::find(self->state.report.islands, id, &report::island_report::id);
}

/// Any of the elements that `fits`; nullptr if none does.
template <class Map, class Predicate>
auto* draw(ecology_pointer self, Map& all, Predicate fits) {
  std::vector<typename Map::mapped_type*> found;
  for (auto& [key, x] : all) {
    if (fits(x))
      found.push_back(&x);
  }
  return found.empty() ? nullptr : found[self->state.rng.below(found.size())];
}

/// The mote that a fault names, or one that is drawn.
supervised_mote* find_mote(ecology_pointer self, const mote_address& x) {
  auto& motes = self->state.motes;
  if (x == config::any_mote)
    return draw(self, motes, [](const supervised_mote& mote) { return !mote.flat && mote.handle; });
  return &mote_now(self, x);
}

bool has_several_gateways(ecology_pointer self, island_id id) {
  return !std::ranges::find(self->state.description.islands, id, &config::island_description::id)
              ->aliases.empty();
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

/// A mote that has left because its battery ends, or by its own wish, is not missed.
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
      note_event(self, "mote/" + find_mote(self, x.mote)->arguments->name,
                 "left " + island_of(self, x.mote.island).name + ": " +
                     network::to_string(x.cause));
    return;
  }
  auto& mote = found->second;
  const std::pair news{x.listed, x.incarnation};
  if (has_several_gateways(self, x.mote.island) && mote.told == news)
    return; // another gateway has told so
  mote.told = news;
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

/// The second mote that has sent the present message; nullptr: it is of no such mote.
supervised_double* double_of_sender(ecology_pointer self) {
  for (auto& [fault, x] : self->state.doubles)
    if (x.handle && x.handle.id() == self->sender())
      return &x;
  return nullptr;
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

void on_flat(ecology_pointer self, supervised_mote& mote) {
  mote.flat = true;
  mote.changed = now(self);
  if (self->state.process.on_flat)
    self->state.process.on_flat(mote.arguments->name);
}

/// The mote that a fault names, if it runs, or one that does and is drawn; nullptr: none.
supervised_mote* find_running_mote(ecology_pointer self, const mote_address& x) {
  auto* mote = find_mote(self, x);
  return mote != nullptr && mote->handle && !mote->flat ? mote : nullptr;
}

/// The same of sinks.
supervised_sink* find_running_sink(ecology_pointer self, island_id x) {
  auto& sinks = self->state.sinks;
  if (x == config::any_island)
    return draw(self, sinks, [](const supervised_sink& sink) { return sink.handle != nullptr; });
  auto& sink = sinks.at(x);
  return sink.handle ? &sink : nullptr;
}

std::string clock_event(duration by) {
  return "clock set " + std::string(by < 0s ? "back by " : "forward by ") +
         to_text(by < 0s ? -by : by);
}

struct fault_applier : peer_fault_applier {
  std::uint32_t index = 0; ///< of the fault in the description

  using peer_fault_applier::operator();

  void operator()(const config::change& x) const { std::visit(change_applier{self}, x); }

  void operator()(const config::battery_end_fault& x) const {
    auto* found = find_mote(self, x.mote);
    if (found == nullptr || found->flat)
      return;
    auto& mote = *found;
    if (mote.handle) {
      self->send(mote.handle, end_battery{});
      return;
    }
    on_flat(self, mote); // while it was out of order: it will not start again
    self->send(mote.arguments->air, radio_power{mote.arguments->radio, radio::power::flat});
    note_event(self, "mote/" + mote.arguments->name, "battery flat");
  }

  void operator()(const config::crash_fault& x) const {
    if (auto* mote = find_running_mote(self, x.mote))
      end(mote->handle, "mote/" + mote->arguments->name, x.length);
  }

  void operator()(const config::sink_crash_fault& x) const {
    if (auto* sink = find_running_sink(self, x.island))
      end(sink->handle, sink->path, x.length);
  }

  template <class Handle>
  void end(const Handle& who, const std::string& path, duration length) const {
    self->state.planned_ends.push_back({path, length, index});
    self->send(who, crash_now{});
  }

  void operator()(const config::crystal_step_fault& x) const {
    if (auto* mote = find_running_mote(self, x.mote))
      set_clock(*mote, "mote/" + mote->arguments->name, x.by);
  }

  void operator()(const config::sink_step_fault& x) const {
    if (auto* sink = find_running_sink(self, x.island))
      set_clock(*sink, event_source(*sink), x.by);
  }

  template <class Supervised>
  void set_clock(Supervised& who, const std::string& name, duration by) const {
    self->state.last_clock_fault[who.arguments->address.island] = now(self);
    who.changed = now(self);
    self->send(who.handle, step_clock{by});
    note_event(self, name, clock_event(by));
  }

  void operator()(const config::noise_fault& x) const {
    const auto& source = self->state.noises.at(index);
    self->send(source.air, make_noise{source.radio, x.duty, x.burst, x.length});
    note_event(self, self->path(),
               "noise at " + std::to_string(std::lround(x.place.x_m)) + ", " +
                   std::to_string(std::lround(x.place.y_m)) + " for " + to_text(x.length));
  }

  void operator()(const config::radio_loss_fault& x) const {
    auto& airs = self->state.airs;
    if (!x.island) {
      std::vector<air_actor> all; // several islands may share one
      for (const auto& [island, air] : airs)
        if (std::ranges::find(all, air) == all.end())
          all.push_back(air);
      for (const auto& air : all)
        self->send(air, lose_frames{true, {}, x.loss, x.length});
    } else {
      auto island = *x.island;
      if (airs.empty())
        return; // all islands are real
      if (island == config::any_island)
        island =
            std::next(airs.begin(), static_cast<std::ptrdiff_t>(self->state.rng.below(airs.size())))
                ->first;
      self->send(airs.at(island), lose_frames{false, island, x.loss, x.length});
      note_event(self, island_of(self, island).name, "radio loses frames for " + to_text(x.length));
      return;
    }
    note_event(self, self->path(), "radio loses frames for " + to_text(x.length));
  }

  void operator()(const config::mote_double_fault& x) const {
    auto& state = self->state;
    auto& second = state.doubles[index];
    if (second.handle)
      return;
    const auto& arguments = state.successors.at(index);
    const auto path = "mote/" + arguments->name;
    note_event(self, path, "appears, with the id of " + find_mote(self, x.mote)->arguments->name);
    second.handle = spawn_child(*state.processes.at(arguments->address.island), self, path,
                                mote_behavior, arguments, mote::nonvolatile{second.store});
    if (x.length)
      self->delayed_send(self, *x.length, end_fault{index});
  }

  void operator()(const config::move_island_fault& x) const {
    if (self->state.moved.contains(x.mote))
      return; // it is not there any more
    if (auto* mote = find_running_mote(self, x.mote))
      end(mote->handle, "mote/" + mote->arguments->name, x.length);
  }

  void operator()(const config::unplug_fault& x) const {
    if (x.further_sink) {
      unplug(self->state.backbones.at(*x.further_sink), x.length);
      return;
    }
    auto& lines = self->state.lines;
    if (x.island == config::any_island) {
      if (const auto* line = draw(self, lines, [](const serial_line_actor&) { return true; }))
        unplug(*line, x.length);
      return;
    }
    for (const auto& [which, line] : lines) {
      if (which.first == x.island && (!x.gateway || *x.gateway == gateway_at(which)))
        unplug(line, x.length);
    }
    const auto real = self->state.real_lines.find(x.island);
    if (real != self->state.real_lines.end() && !x.gateway)
      unplug(real->second, x.length);
  }

  template <class Line>
  void unplug(const Line& line, duration length) const {
    self->send(line, plug_serial{false});
    self->delayed_send(line, length, plug_serial{true});
  }

  [[nodiscard]] peer_id gateway_at(const std::pair<island_id, std::size_t>& line) const {
    const auto found = std::ranges::find_if(self->state.peers, [&line](const auto& x) {
      return x.second.island == line.first && x.second.line == line.second;
    });
    return found->second.id;
  }
};

/// A second mote is switched off. What it has counted is part of the report.
void end_double(ecology_pointer self, std::uint32_t fault) {
  auto& state = self->state;
  auto& second = state.doubles.at(fault);
  if (!second.handle)
    return;
  const auto who = second.handle.address();
  self->send(second.handle, status_request{});
  self->send_exit(second.handle, caf::exit_reason::user_shutdown);
  const auto& of = *state.successors.at(fault);
  self->send(of.air, radio_power{of.radio, radio::power::off});
  std::erase_if(state.reporters, [&who](const auto& x) { return x.first == who; });
}

/// It has ended, having told all that it had to.
bool on_double_down(ecology_pointer self, const caf::down_msg& x) {
  for (auto& [fault, second] : self->state.doubles) {
    if (!second.handle || second.handle.address() != x.source)
      continue;
    const auto path = "mote/" + self->state.successors.at(fault)->name;
    self->state.names.erase(x.source);
    second.handle = nullptr;
    if (!was_asked_to_end(x.reason))
      record_failure(self, path, text_of(x.reason));
    note_event(self, path, "gone");
    return true;
  }
  return false;
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
  if (auto* mote = find_mote(self, x.used.mote))
    mote->used_mah = x.used.energy.used_mah;
}

void restart(ecology_pointer self, const restart_mote& x) {
  auto& mote = self->state.motes.at(x.mote);
  if (mote.flat)
    return;
  if (std::exchange(mote.in_transit, false))
    self->send(mote.arguments->air, bring_radio{mote.arguments->radio, mote.used_mah});
  spawn_mote(self, mote);
}

/// Until when a fault lasts. What happens to a mote is seen by looking at it, whether others need
/// it or not.
template <class Fault>
instant end_of(const Fault& x, instant now) {
  if constexpr (std::is_same_v<Fault, config::mote_double_fault> ||
                std::is_same_v<Fault, config::duplicate_id_fault>)
    return x.length ? now + *x.length : instant::max();
  else if constexpr (requires { x.length.has_value(); })
    return now + x.length.value_or(0s);
  else if constexpr (
      requires { x.length; } && !requires { x.mote; })
    return now + x.length;
  else
    return now;
}

/// Where a fault is felt; nothing: perhaps everywhere.
template <class Fault>
std::optional<island_id> place_of(const Fault& x) {
  std::optional<island_id> place;
  if constexpr (std::is_same_v<Fault, config::move_island_fault> ||
                std::is_same_v<Fault, config::noise_fault>)
    return std::nullopt;
  else if constexpr (requires { x.mote.island; })
    place = x.mote.island;
  else if constexpr (requires { x.island; })
    place = x.island;
  return place && *place != config::any_island && *place != config::any_mote.island ? place
                                                                                    : std::nullopt;
}

/// What a mote does wrong soon after it is not held against it.
void note_cause(ecology_pointer self, const config::fault& x) {
  std::visit(
      [self](const auto& fault) {
        auto& watch = self->state.watch;
        const auto until = end_of(fault, now(self));
        if (const auto place = place_of(fault))
          watch.on_cause(*place, until);
        else
          watch.on_cause(until);
      },
      x);
}

/// The next fault of the plan; the plan may be long.
void schedule_fault(ecology_pointer self) {
  auto& state = self->state;
  if (state.next_fault == state.plan.size())
    return;
  const auto& next = state.plan[state.next_fault++];
  self->scheduled_send(self, instant(next.at), apply_fault{next.index});
}

/// The clocks are compared when all have told theirs.
void on_network(ecology_pointer self, const network_status& x) {
  auto& island = island_of(self, x.address.island);
  island.network += x.network;
  const auto mote = std::ranges::find(island.motes, x.address, &report::mote_report::address);
  if (mote != island.motes.end()) {
    mote->parent = x.parent;
    mote->hops = x.hops;
    if (x.has_signal && x.parent != mote_id{})
      mote->signal_dbm = x.signal_dbm;
  }
  if (x.is_sink || (mote != island.motes.end() && mote->alive))
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

/// `kitchen/fan`, or the name of a peer.
std::string node_name(ecology_pointer self, const mote_address& x) {
  const auto& state = self->state;
  if (const auto mote = state.motes.find(x); mote != state.motes.end())
    return mote->second.arguments->name;
  if (state.description.part)
    if (auto name = name_elsewhere(*state.description.part, x); !name.empty())
      return name;
  const auto peer = std::ranges::find_if(state.peers, [&x](const auto& each) {
    return each.second.id.value == static_cast<std::int32_t>(x.island.value);
  });
  return x.mote == no_mote && peer != state.peers.end() ? peer->first : to_string(x);
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

/// Only those answer who have something to tell of.
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

void compare(ecology_pointer self, const mote_address& mote, std::int64_t apart_us) {
  self->state.process.judge->on_clock(mote, node_name(self, mote),
                                      std::chrono::microseconds(std::abs(apart_us)), now(self));
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

void on_lead(ecology_pointer self, const gateway_status& x) {
  auto& all = island_of(self, x.island).gateways;
  const auto found = std::ranges::find(all, x.gateway, &report::gateway_report::id);
  if (found != all.end())
    found->lead += x.lead;
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

/// The part of the report that the supervisor itself knows about its motes.
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
  auto& motes = island_of(self, x.mote.island).motes;
  const auto found = std::ranges::find(motes, x.mote, &report::mote_report::address);
  if (found != motes.end()) // else a sink: it lives on its cable
    found->energy = x.energy;
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

/// Whether nothing has happened to an island's motes for longer than any channel lasts without
/// packets.
bool is_quiet(ecology_pointer self, island_id island) {
  constexpr duration longest = 15min;
  const auto sink = self->state.sinks.find(island);
  if (sink != self->state.sinks.end() && now(self) - sink->second.changed < longest)
    return false;
  return std::ranges::all_of(self->state.motes, [&](const auto& x) {
    return x.first.island != island || now(self) - x.second.changed >= longest;
  });
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

/// What the invariants compare the report with.
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
    if (!listed || now(self) - since < settling_time(*find_mote(self, address)))
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
  for (const auto& [address, table] : state.channel_tables)
    if (is_quiet(self, address.island))
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

/// `lab/sink`, `lab/mote-7`, `lab/*`
std::string mote_name(ecology_pointer self, const mote_address& x) {
  const auto island = island_of(self, x.island).name;
  if (x.mote == broadcast_mote)
    return island + "/*";
  const auto found = self->state.motes.find(x);
  return found == self->state.motes.end() ? island + "/sink" : found->second.arguments->name;
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
  self->state.watch.tell(report, now(self));
  for (auto& x : report::check_all(report, truth_of(self)))
    report.violations.push_back(std::move(x));
  if (report.islands.empty() && report.peers.empty())
    add_violation(self, report::requests_are_met, "there is no island and no peer: nothing ran");
  report.complete = true;
  self->state.delivered = true;
  self->state.on_report(report); // not moved: programs that end later still tell their counters
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
      [self](const apply_fault& x) {
        if (x.index < self->state.planned_faults)
          schedule_fault(self);
        const auto& fault = self->state.description.faults.at(x.index).what;
        note_cause(self, fault);
        std::visit(fault_applier{{self}, x.index}, fault);
      },
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
