#include "actors/island/base_station.hpp"

#include <stdexcept>
#include <utility>

#include "actors/base/failure.hpp"
#include "actors/base/log.hpp"
#include "actors/base/statuses.hpp"
#include "actors/messages/air.hpp"
#include "actors/messages/common.hpp"
#include "actors/messages/programs.hpp"
#include "actors/messages/serial.hpp"
#include "actors/messages/supervision.hpp"
#include "report/report.hpp"

namespace rubicon {

namespace {

using base_station_pointer = scheduler::actor_pointer<sink_state, sink_actor>;

serial::mote_port& port_of(base_station_pointer self) {
  return self->state.ports.front();
}

void transmit(base_station_pointer self, std::optional<tinyos::to_radio> x) {
  if (!x)
    return;
  const acting_on its(x->from);
  self->send(self->state.arguments.air,
             radio_send{self->state.arguments.radio, 0, x->destination, x->am_type,
                        payload(std::move(x->payload)), false});
}

struct base_station_performer {
  base_station_pointer self;

  void operator()(serial::to_line& x) const {
    const acting_on its(x.from);
    self->send(self->state.arguments.lines.front().line,
               serial_write{serial::direction::to_pc, payload(std::move(x.octets))});
  }
  void operator()(const serial::received& x) const {
    transmit(self, self->state.base->on_packet(x.packet));
  }
};

void perform(base_station_pointer self, serial::mote_port_outputs todo) {
  for (auto& output : todo)
    std::visit(base_station_performer{self}, output);
  self->state.wake.follow(self, port_of(self).deadline());
}

void on_frame(base_station_pointer self, byte_view psdu) {
  constexpr std::size_t fcs_octets = 2;
  if (const auto x = radio::decode(psdu); !x) {
    if (psdu.size() > fcs_octets)
      perform(self,
              port_of(self).send(
                  self->state.base->on_raw_frame(psdu.first(psdu.size() - fcs_octets)), now(self)));
  } else if (const auto packet = self->state.base->on_frame(
                 {x->pan, x->destination, x->source, x->am_type, x->payload})) {
    perform(self, port_of(self).send(serial::encode(*packet), now(self)));
  }
}

tinyos::radio_result result_of(radio::send_status x) {
  switch (x) {
  case radio::send_status::channel_access_failure:
    return tinyos::radio_result::busy;
  case radio::send_status::aborted:
  case radio::send_status::queue_full: // it has one request at a time
    return tinyos::radio_result::off;
  case radio::send_status::sent:
  case radio::send_status::no_ack: // it asks for none
    break;
  }
  return tinyos::radio_result::sent;
}

void send_status(base_station_pointer self) {
  const auto& arguments = self->state.arguments;
  self->send(arguments.ecology, serial_status{arguments.address.island, counted(self->state)});
  report::cause_counts modules;
  report::add_counters<tinyos::base_station_counters>(modules, "base_station",
                                                      self->state.base->counters());
  report::add_counters<serial::mote_port_counters>(modules, "serial", port_of(self).counters());
  send_modules(self, arguments.ecology, self->path(), std::move(modules));
}

} // namespace

sink_actor::behavior_type base_station(base_station_pointer self, sink_arguments arguments,
                                       mote::nonvolatile store) {
  self->set_exception_handler([self](std::exception_ptr& x) { // what this life has counted stays
    send_status(self);
    return scheduler::failure_of(x);
  });
  auto& state = self->state;
  state.arguments = std::move(arguments);
  state.base = std::make_unique<tinyos::base_station>();
  ++store.starts;
  const auto& line = state.arguments.lines.front();
  state.ports.emplace_back(line.port);
  const auto handle = handle_of<sink_actor>(self);
  self->send(state.arguments.ecology, store_written{state.arguments.address, store});
  self->send(state.arguments.air, attach_radio{state.arguments.radio, {handle}});
  self->send(line.line, attach_serial{serial::direction::to_mote, {handle}});
  return {
      [self](const frame_received& x) { on_frame(self, x.psdu.view()); },
      [self](const radio_done& x) {
        transmit(self, self->state.base->on_radio_done(result_of(x.status)));
      },
      [self](const timer_expired& x) {
        if (self->state.wake.accepts(x))
          perform(self, port_of(self).on_time(now(self)));
      },
      [self](const serial_octets& x) {
        perform(self, port_of(self).on_bytes(x.octets.view(), now(self)));
      },
      [](battery_low) {}, // it is fed by its cable
      [](battery_flat) {},
      [](const backbone_received&) {}, // it has none
      [](const backbone_sent&) {},
      [](crash_now) { throw std::runtime_error(std::string(planned_crash)); },
      [](const step_clock&) {}, // it gives no mote the time
      [self](const status_request& x) {
        if (x.sample == 0)
          send_status(self);
      },
  };
}

} // namespace rubicon
