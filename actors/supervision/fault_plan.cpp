#include "actors/supervision/fault_plan.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <type_traits>
#include <utility>
#include <vector>

#include "actors/base/failure.hpp"
#include "actors/island/mote.hpp"
#include "actors/island/sink.hpp"
#include "actors/messages/air.hpp"
#include "actors/messages/common.hpp"
#include "actors/messages/serial.hpp"
#include "actors/supervision/changes.hpp"
#include "actors/supervision/peer_supervision.hpp"
#include "actors/supervision/supervised.hpp"

namespace rubicon {

namespace {

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

} // namespace

supervised_double* double_of_sender(ecology_pointer self) {
  for (auto& [fault, x] : self->state.doubles)
    if (x.handle && x.handle.id() == self->sender())
      return &x;
  return nullptr;
}

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

void schedule_fault(ecology_pointer self) {
  auto& state = self->state;
  if (state.next_fault == state.plan.size())
    return;
  const auto& next = state.plan[state.next_fault++];
  self->scheduled_send(self, instant(next.at), apply_fault{next.index});
}

void apply(ecology_pointer self, const apply_fault& x) {
  if (x.index < self->state.planned_faults)
    schedule_fault(self);
  const auto& fault = self->state.description.faults.at(x.index).what;
  note_cause(self, fault);
  std::visit(fault_applier{{self}, x.index}, fault);
}

} // namespace rubicon
