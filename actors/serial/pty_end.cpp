#include "actors/serial/pty_end.hpp"

#include <utility>
#include <variant>

#include "actors/base/log.hpp"
#include "actors/messages/common.hpp"
#include "actors/messages/serial.hpp"
#include "actors/messages/supervision.hpp"
#include "core/tuples/hand_over.hpp"

namespace rubicon {

namespace {

using end_pointer = scheduler::actor_pointer<pty_end_state, pty_end_actor>;

void open(end_pointer self) {
  auto& state = self->state;
  const auto& arguments = state.arguments;
  auto x = io::pseudo_terminal::open(*arguments.loop, arguments.link, arguments.buffer);
  if (auto* why = std::get_if<std::string>(&x)) {
    self->send(arguments.ecology, request_unmet{self->path(), std::move(*why)});
    return;
  }
  state.pty = std::get<io::pseudo_terminal>(std::move(x));
  const auto me = handle_of<pty_end_actor>(self);
  state.pty->start({[self, me](byte_view octets) {
                      self->state.pty->read(false); // until this has been handled
                      post(me, serial_write{serial::direction::to_mote, payload(to_bytes(octets))});
                    },
                    [me](bool attached) {
                      post(me, serial_presence{attached, {}});
                    }});
}

void on_octets(end_pointer self, const payload& octets) {
  auto& state = self->state;
  if (state.pty && state.pty->send(octets)) {
    hand_over();
  } else {
    (state.attached ? state.slow : state.absent) += octets.size();
    note_loss(loss::line_failed);
  }
}

void on_presence(end_pointer self, bool attached) {
  log(self, spdlog::level::info, "event={}", attached ? "attached" : "detached");
  self->state.attached = attached;
  self->send(self->state.arguments.ecology,
             notable_event{self->path(),
                           (attached ? "a program has opened " : "no program has open any more ") +
                               self->state.arguments.link});
}

void send_status(end_pointer self) {
  serial_status status{self->state.arguments.island, {}};
  status.serial.lost = {{"pty_nobody_octets", self->state.absent},
                        {"pty_slow_octets", self->state.slow}};
  self->send(self->state.arguments.ecology, std::move(status));
}

} // namespace

pty_end_actor::behavior_type pty_end(end_pointer self, pty_end_arguments arguments) {
  self->state.arguments = std::move(arguments);
  open(self);
  self->send(self->state.arguments.line,
             attach_serial{serial::direction::to_pc, {handle_of<serial_end_actor>(self)}});
  return {
      [self](const serial_octets& x) { on_octets(self, x.octets); },
      [self](const serial_write& x) {
        self->send(self->state.arguments.line, x);
        self->state.pty->read(true);
      },
      [self](const serial_presence& x) { on_presence(self, x.there); },
      [self](status_request) { send_status(self); },
  };
}

} // namespace rubicon
