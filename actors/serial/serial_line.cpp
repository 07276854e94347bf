#include "actors/serial/serial_line.hpp"

#include "actors/base/log.hpp"
#include "actors/messages/common.hpp"
#include "actors/messages/serial.hpp"
#include "actors/messages/supervision.hpp"

namespace rubicon {

namespace {

using serial_line_pointer = scheduler::actor_pointer<serial_line_state, serial_line_actor>;

void perform(serial_line_pointer self, serial::line_outputs todo) {
  for (auto& x : todo) {
    const acting_on its(x.from);
    const auto& end = self->state.ends[static_cast<std::size_t>(x.towards)];
    if (!end) {
      self->state.unheard += x.octets.size();
      note_loss(loss::line_failed);
    } else if (x.towards == serial::direction::to_pc) {
      self->delayed_send(end, self->state.latency, serial_octets{std::move(x.octets)});
    } else {
      self->send(end, serial_octets{std::move(x.octets)});
    }
  }
  self->state.wake.follow(self, self->state.line.deadline());
}

void plug(serial_line_pointer self, bool plugged) {
  log(self, spdlog::level::info, "event={}", plugged ? "plugged" : "unplugged");
  self->send(self->state.ecology,
             notable_event{self->path(),
                           plugged ? "serial cable plugged in again" : "serial cable unplugged"});
  if (plugged)
    self->state.line.plug();
  else
    perform(self, self->state.line.unplug(now(self)));
}

void send_status(serial_line_pointer self) {
  self->send(self->state.ecology, serial_status{self->state.island, counted(self->state)});
}

} // namespace

report::serial_report counted(const serial_line_state& x) {
  report::serial_report sum;
  for (const auto towards : {serial::direction::to_pc, serial::direction::to_mote}) {
    const auto& lane = x.line.counters(towards);
    sum.octets_written += lane.written;
    sum.octets += lane.arrived;
    sum.lost["line_overflow_octets"] += lane.overflow;
    sum.lost["unplugged_octets"] += lane.unplugged;
    sum.lost["corrupted_octets"] += lane.corrupted;
  }
  if (x.unheard > 0)
    sum.lost["end_off_octets"] = x.unheard;
  sum.octets_up = x.line.counters(serial::direction::to_pc).arrived;
  return sum;
}

serial_line_actor::behavior_type serial_line(serial_line_pointer self, serial::line line,
                                             duration latency, island_id island,
                                             ecology_actor ecology) {
  self->state.line = std::move(line);
  self->state.latency = latency;
  self->state.island = island;
  self->state.ecology = std::move(ecology);
  return {
      [self](const serial_write& x) {
        self->state.line.send(x.towards, x.octets, now(self));
        self->state.wake.follow(self, self->state.line.deadline());
      },
      [self](const timer_expired& x) {
        if (self->state.wake.accepts(x))
          perform(self, self->state.line.on_time(now(self)));
      },
      [self](const attach_serial& x) {
        self->state.ends[static_cast<std::size_t>(x.towards)] = x.user;
      },
      [self](plug_serial x) { plug(self, x.plugged); },
      [self](status_request) { send_status(self); },
      [](const watch_line&) {}, // its far end is a sink, which is always there
  };
}

} // namespace rubicon
