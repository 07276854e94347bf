#include "actors/apps/rfid_reader.hpp"

#include <variant>

#include "actors/log.hpp"
#include "scheduler/supervision.hpp"

namespace rubicon {

namespace {

using reader_pointer = scheduler::traced_pointer<rfid_reader_state, timed_peer_app_actor>;

struct performer {
  reader_pointer self;

  void operator()(rfid::publish& x) const {
    self->send(self->state.peer, set_tuple{std::move(x.key), payload(std::move(x.value)), x.text});
  }
  void operator()(rfid::erase& x) const {
    self->send(self->state.peer, delete_tuple{std::move(x.key)});
  }
};

void perform(reader_pointer self, rfid::outputs todo) {
  for (auto& output : todo)
    std::visit(performer{self}, output);
  self->state.wake.follow(self, self->state.core.deadline());
}

} // namespace

timed_peer_app_actor::behavior_type rfid_reader(reader_pointer self, rfid::reader core,
                                                peis_peer_actor peer) {
  scheduler::tell_monitors_of_exceptions(self);
  self->state.core = std::move(core);
  self->state.peer = std::move(peer);
  perform(self, self->state.core.start(now(self)));
  return {
      [](const tuple_event&) {}, // watches nothing
      [](const peis_message&) {},
      [](const peis_outcome&) {},
      [self](status_request) {
        log(self, spdlog::level::info, "event=perceives tags={}", self->state.core.perceived());
      },
      [self](const timer_expired& x) {
        if (self->state.wake.accepts(x))
          perform(self, self->state.core.on_time(now(self)));
      },
  };
}

} // namespace rubicon
