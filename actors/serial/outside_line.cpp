#include "actors/serial/outside_line.hpp"

#include <utility>

#include "actors/base/log.hpp"
#include "actors/messages/common.hpp"
#include "actors/messages/serial.hpp"
#include "actors/messages/supervision.hpp"
#include "core/tuples/hand_over.hpp"

namespace rubicon {

namespace {

using outside_line_pointer = scheduler::actor_pointer<outside_line_state, outside_line_actor>;

void tell(outside_line_pointer self, std::string what) {
  log(self, self->state.there ? spdlog::level::info : spdlog::level::warn, "event={} what=\"{}\"",
      self->state.there ? "sink_found" : "sink_lost", what);
  self->send(self->state.arguments.ecology, notable_event{self->path(), std::move(what)});
}

void on_presence(outside_line_pointer self, const serial_presence& x) {
  auto& state = self->state;
  if (!state.plugged)
    return;
  state.there = x.there;
  if (state.watcher)
    self->send(state.watcher, x);
  if (x.there) {
    state.told.clear();
    state.next_try.reset();
    state.reopening.on_opened(now(self));
    tell(self, "has " + name_of(state.arguments.access));
  } else {
    state.next_try = now(self) + state.reopening.on_closed(now(self));
    if (std::exchange(state.told, x.why) != x.why)
      tell(self, x.why + "; tries again");
  }
  state.wake.follow(self, state.next_try);
}

void on_write(outside_line_pointer self, const payload& octets) {
  auto& state = self->state;
  if (!state.there) {
    state.unplugged += octets.size();
    note_loss(loss::line_failed);
  } else if (state.access->send(octets)) {
    state.down += octets.size();
    hand_over();
  } else {
    state.overflow += octets.size();
    note_loss(loss::line_failed);
  }
}

void on_octets(outside_line_pointer self, const serial_octets& x) {
  auto& state = self->state;
  state.up += x.octets.size();
  if (state.gives_octets && state.watcher)
    self->send(state.watcher, real_octets{x.octets});
  else if (state.pc)
    self->send(state.pc, x);
  else
    state.unheard += x.octets.size();
  state.access->on_taken();
}

void plug(outside_line_pointer self, bool plugged) {
  auto& state = self->state;
  state.plugged = plugged;
  if (std::exchange(state.there, false) && state.watcher)
    self->send(state.watcher, serial_presence{});
  state.next_try.reset();
  state.wake.follow(self, state.next_try);
  log(self, spdlog::level::info, "event={}", plugged ? "plugged" : "unplugged");
  self->send(state.arguments.ecology,
             notable_event{self->path(),
                           plugged ? "serial cable plugged in again" : "serial cable unplugged"});
  if (plugged)
    state.access->open();
  else
    state.access->close();
}

void send_status(outside_line_pointer self) {
  const auto& state = self->state;
  serial_status status{state.arguments.island, {}};
  status.serial.octets = state.up + state.down;
  status.serial.octets_up = state.up;
  status.serial.lost = {{"line_overflow_octets", state.overflow},
                        {"unplugged_octets", state.unplugged}};
  if (state.unheard > 0)
    status.serial.lost["end_off_octets"] = state.unheard;
  self->send(state.arguments.ecology, std::move(status));
}

} // namespace

outside_line_actor::behavior_type outside_line(outside_line_pointer self,
                                               outside_line_arguments arguments) {
  auto& state = self->state;
  state.arguments = std::move(arguments);
  state.access = make_access(*state.arguments.loop, state.arguments.access,
                             handle_of<outside_line_actor>(self));
  state.access->open();
  return {
      [self](const serial_write& x) { on_write(self, x.octets); },
      [self](const timer_expired& x) {
        if (self->state.wake.accepts(x)) {
          self->state.next_try.reset();
          self->state.access->open();
        }
      },
      [self](const attach_serial& x) {
        if (x.towards == serial::direction::to_pc)
          self->state.pc = x.user;
      },
      [self](plug_serial x) { plug(self, x.plugged); },
      [self](status_request) { send_status(self); },
      [self](const serial_octets& x) { on_octets(self, x); },
      [self](const serial_presence& x) { on_presence(self, x); },
      [self](const watch_line& x) {
        self->state.watcher = x.user;
        self->state.gives_octets = x.takes_octets;
        if (self->state.watcher)
          self->send(self->state.watcher, serial_presence{self->state.there, {}});
      },
  };
}

} // namespace rubicon
