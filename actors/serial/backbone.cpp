#include "actors/serial/backbone.hpp"

#include <utility>
#include <variant>

#include "actors/base/log.hpp"
#include "actors/messages/common.hpp"
#include "network/router.hpp"

namespace rubicon {

namespace {

using backbone_pointer = scheduler::actor_pointer<backbone_state, backbone_actor>;
using serial::backbone_direction;

backbone_direction direction_of(bool down) {
  return down ? backbone_direction::down : backbone_direction::up;
}

struct backbone_performer {
  backbone_pointer self;

  void operator()(serial::backbone_arrived& x) const {
    const acting_on its(x.from);
    const auto& place = self->state.place;
    self->send(end_of(x.to),
               backbone_received{x.to == backbone_direction::up ? place.further : place.sink,
                                 x.am_type, std::move(x.octets), x.age});
  }

  void operator()(const serial::backbone_done& x) const {
    const acting_on its(x.from);
    if (const auto& sender = end_of(opposite(x.to)))
      self->send(sender, backbone_sent{x.token, x.acked});
  }

  [[nodiscard]] const backbone_end_actor& end_of(backbone_direction to) const {
    return self->state.ends[static_cast<std::size_t>(to)];
  }
};

void perform(backbone_pointer self, serial::backbone_outputs todo) {
  for (auto& x : todo)
    std::visit(backbone_performer{self}, x);
  self->state.wake.follow(self, self->state.link.deadline());
}

void plug(backbone_pointer self, bool plugged) {
  log(self, spdlog::level::info, "event={}", plugged ? "repaired" : "cut");
  self->send(self->state.ecology,
             notable_event{self->path(), plugged ? "backbone repaired" : "backbone cut"});
  if (plugged)
    self->state.link.repair();
  else
    perform(self, self->state.link.cut(now(self)));
}

void send_status(backbone_pointer self) {
  const auto& up = self->state.link.counters(backbone_direction::up);
  const auto& down = self->state.link.counters(backbone_direction::down);
  backbone_status x{self->state.place.island, {}};
  x.backbone.sent = up.sent + down.sent;
  x.backbone.up = up.arrived;
  x.backbone.down = down.arrived;
  x.backbone.lost["queue_full"] = up.overflow + down.overflow;
  x.backbone.lost["cut"] = up.cut + down.cut;
  x.backbone.lost["end_off"] = up.end_off + down.end_off;
  self->send(self->state.ecology, std::move(x));
}

} // namespace

backbone_actor::behavior_type backbone(backbone_pointer self, serial::backbone link,
                                       backbone_place place, ecology_actor ecology) {
  self->state.link = std::move(link);
  self->state.place = place;
  self->state.ecology = std::move(ecology);
  return {
      [self](const attach_backbone& x) {
        const auto to = direction_of(x.down);
        perform(self, self->state.link.on_time(now(self)));
        self->state.ends[static_cast<std::size_t>(to)] = x.user;
        self->state.link.set_end(to, static_cast<bool>(x.user));
      },
      [self](const backbone_write& x) {
        serial::backbone_packet packet{std::nullopt, x.am_type, x.octets};
        if (x.token != network::no_token)
          packet.token = x.token;
        self->state.link.send(direction_of(x.down), std::move(packet), now(self));
        self->state.wake.follow(self, self->state.link.deadline());
      },
      [self](plug_serial x) { plug(self, x.plugged); },
      [self](const timer_expired& x) {
        if (self->state.wake.accepts(x))
          perform(self, self->state.link.on_time(now(self)));
      },
      [self](status_request) { send_status(self); },
  };
}

} // namespace rubicon
