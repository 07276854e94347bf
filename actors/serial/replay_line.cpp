#include "actors/serial/replay_line.hpp"

#include <utility>

#include "actors/base/log.hpp"
#include "actors/messages/common.hpp"
#include "actors/messages/serial.hpp"
#include "actors/messages/supervision.hpp"
#include "core/tuples/hand_over.hpp"

namespace rubicon {

namespace {

using replay_line_pointer = scheduler::actor_pointer<replay_line_state, serial_line_actor>;

void give(replay_line_pointer self, bytes octets) {
  auto& state = self->state;
  if (octets.empty())
    return;
  if (!state.plugged || (!state.pc && !state.gives_octets)) {
    state.unplugged += octets.size();
    return;
  }
  state.up += octets.size();
  if (state.gives_octets && !state.watcher) {
    state.unheard += octets.size();
    return;
  }
  if (state.gives_octets)
    self->send(state.watcher, real_octets{payload(std::move(octets))});
  else
    self->send(state.pc, serial_octets{payload(std::move(octets))});
}

void on_write(replay_line_pointer self, const payload& octets) {
  auto& state = self->state;
  if (!state.plugged) {
    state.unplugged += octets.size();
    note_loss(loss::line_failed);
    return;
  }
  hand_over(); // to a sink that is no more
  state.down += octets.size();
  give(self, state.replay.on_pc(octets.view()));
}

void plug(replay_line_pointer self, bool plugged) {
  self->state.plugged = plugged;
  if (self->state.watcher)
    self->send(self->state.watcher, serial_presence{plugged, {}});
  self->send(self->state.ecology,
             notable_event{self->path(),
                           plugged ? "serial cable plugged in again" : "serial cable unplugged"});
}

void send_status(replay_line_pointer self) {
  const auto& state = self->state;
  serial_status status{state.island, {}};
  status.serial.octets = state.up + state.down;
  status.serial.octets_up = state.up;
  status.serial.lost = {{"unplugged_octets", state.unplugged}};
  if (state.unheard > 0)
    status.serial.lost["end_off_octets"] = state.unheard;
  self->send(state.ecology, std::move(status));
}

} // namespace

serial_line_actor::behavior_type replay_line(replay_line_pointer self, serial::replay replay,
                                             island_id island, ecology_actor ecology) {
  self->state.replay = std::move(replay);
  self->state.island = island;
  self->state.ecology = std::move(ecology);
  self->state.wake.follow(self, self->state.replay.deadline());
  return {
      [self](const serial_write& x) { on_write(self, x.octets); },
      [self](const timer_expired& x) {
        if (!self->state.wake.accepts(x))
          return;
        give(self, self->state.replay.on_time(now(self)));
        self->state.wake.follow(self, self->state.replay.deadline());
      },
      [self](const attach_serial& x) {
        if (x.towards == serial::direction::to_pc)
          self->state.pc = x.user;
      },
      [self](plug_serial x) { plug(self, x.plugged); },
      [self](status_request) { send_status(self); },
      [self](const watch_line& x) {
        auto& state = self->state;
        state.watcher = x.user;
        state.gives_octets = x.takes_octets;
        if (state.watcher)
          self->send(state.watcher, serial_presence{state.plugged, {}});
      },
  };
}

} // namespace rubicon
