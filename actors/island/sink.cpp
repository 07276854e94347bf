#include "actors/island/sink.hpp"

#include <algorithm>
#include <stdexcept>

#include "actors/base/failure.hpp"
#include "actors/base/log.hpp"
#include "actors/base/statuses.hpp"
#include "actors/island/network_radio.hpp"
#include "actors/messages/air.hpp"
#include "actors/messages/common.hpp"
#include "actors/messages/programs.hpp"
#include "actors/messages/serial.hpp"
#include "actors/messages/supervision.hpp"
#include "network/am.hpp"

namespace rubicon {

namespace {

using sink_pointer = scheduler::actor_pointer<sink_state, sink_actor>;

void perform(sink_pointer self, mote::sink_outputs todo);
void perform(sink_pointer self, serial::mote_port_outputs todo, std::size_t line);

instant own_time(sink_pointer self) {
  return self->state.arguments.crystal.own(now(self));
}

struct sink_performer {
  sink_pointer self;
  std::size_t line = 0; ///< whose port it is

  void write(const bytes& packet, std::size_t to, serial::urgency how) const;

  void operator()(network::frame_out& x) const {
    const acting_on its(x.from);
    const auto& arguments = self->state.arguments;
    if (x.over == network::medium::backbone)
      self->send(std::ranges::find(arguments.backbones, x.next_hop, &sink_backbone::to)->link,
                 backbone_write{true, x.token, x.am_type, payload(std::move(x.payload))});
    else
      self->send(arguments.air, request_of(arguments.radio, std::move(x)));
  }

  void operator()(mote::to_gateway& x) const {
    // As a TinyOS base station writes it: destination, source and type as on the radio, the group
    // is the island (docs/tinyos.md 3).
    const auto& address = self->state.arguments.address;
    serial::am_packet packet{address.mote.value, x.source.value,
                             static_cast<std::uint8_t>(address.island.value), x.am_type,
                             std::move(x.payload)};
    const auto octets = serial::encode(packet);
    const auto how = x.urgent ? serial::urgency::before_others : serial::urgency::none;
    for (std::size_t i = 0; i < self->state.ports.size(); ++i) {
      if (x.line.value_or(i) != i)
        continue;
      if (x.asks_time)
        self->state.sink.on_question_delayed(self->state.ports[i].wait(now(self)));
      write(octets, i, how);
    }
  }

  void operator()(const mote::store_nonvolatile& x) const {
    self->send(self->state.arguments.ecology,
               store_written{self->state.arguments.address, x.content});
  }

  void operator()(const mote::double_refused& x) const {
    const mote_address who{self->state.arguments.address.island, x.mote};
    log(self, spdlog::level::warn, "event=double_refused mote={} device={:08x}", to_string(who),
        x.device);
    self->send(self->state.arguments.ecology,
               notable_event{self->path() + "/sink",
                             "refused a second mote with the id " + to_string(x.mote)});
  }

  void operator()(serial::to_line& x) const {
    const acting_on its(x.from);
    self->send(self->state.arguments.lines[line].line,
               serial_write{serial::direction::to_pc, payload(std::move(x.octets))});
  }

  void operator()(const serial::received& x) const {
    if (const auto packet = serial::decode_am_packet(x.packet))
      perform(self,
              self->state.sink.on_packet(packet->am_type, packet->payload, own_time(self), line));
  }
};

void follow(sink_pointer self) {
  const auto due = self->state.arguments.crystal.real(self->state.sink.deadline());
  auto ports_due = self->state.ports.front().deadline();
  for (const auto& port : self->state.ports)
    ports_due = earliest(ports_due, port.deadline());
  self->state.wake.follow(self, earliest(due, ports_due));
}

void perform(sink_pointer self, mote::sink_outputs todo) {
  for (auto& output : todo)
    std::visit(sink_performer{self}, output);
  follow(self);
}

void perform(sink_pointer self, serial::mote_port_outputs todo, std::size_t line) {
  for (auto& output : todo)
    std::visit(sink_performer{self, line}, output);
  follow(self);
}

void sink_performer::write(const bytes& packet, std::size_t to, serial::urgency how) const {
  perform(self, self->state.ports[to].send(packet, now(self), how), to);
}

/// Octets of one of its lines, which is known by its actor.
void on_octets(sink_pointer self, const serial_octets& x) {
  const auto& lines = self->state.arguments.lines;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (lines.size() == 1 || lines[i].line.id() == self->sender())
      perform(self, self->state.ports[i].on_bytes(x.octets.view(), now(self)), i);
  }
}

void on_frame(sink_pointer self, const radio::frame& x, instant sfd) {
  if (x.am_type == network::am::smepp)
    return; // between motes
  perform(self, self->state.sink.on_frame(x.source, x.am_type, x.payload,
                                          self->state.arguments.crystal.own(sfd), own_time(self)));
}

/// @param is_alive the clock of a life that has ended is compared with nothing
void send_status(sink_pointer self, bool is_alive) {
  self->send(self->state.arguments.ecology,
             serial_status{self->state.arguments.address.island, counted(self->state)});
  auto network =
      status_of(self->state.arguments.address, self->state.sink, own_time(self), now(self));
  if (!is_alive) {
    network.has_clock = false;
    network.channels.clear();
  }
  for (const auto& port : self->state.ports)
    report::add_counters<serial::mote_port_counters>(network.network.counters, "serial",
                                                     port.counters());
  self->send(self->state.arguments.ecology, std::move(network));
}

/// What this life has counted must not go with it.
void report_failures(sink_pointer self) {
  self->set_exception_handler([self](std::exception_ptr& x) {
    self->state.flows.report(self, self->state.arguments.ecology);
    send_status(self, false);
    return scheduler::failure_of(x);
  });
}

} // namespace

report::serial_report counted(const sink_state& x) {
  report::serial_report sum;
  for (const auto& port : x.ports) {
    const auto& at_port = port.counters();
    sum.frames_sent += at_port.packets_sent + at_port.acks_sent;
    sum.frames_received += at_port.frames_received;
    sum.lost["sink_crc"] += at_port.bad_crc + at_port.too_short + at_port.too_long;
    sum.lost["sink_queue_full"] += at_port.queue_full;
    sum.lost["sink_acks_lost"] += at_port.acks_lost;
    sum.lost["sink_no_buffer"] += at_port.no_buffer;
  }
  return sum;
}

sink_actor::behavior_type sink(sink_pointer self, sink_arguments arguments,
                               mote::nonvolatile store) {
  report_failures(self);
  auto& state = self->state;
  state.arguments = std::move(arguments);
  state.life = self->path() + (store.starts == 0 ? "" : '#' + std::to_string(store.starts));
  auto network = state.arguments.network;
  network.self = state.arguments.address.mote;
  network.tick.period = state.arguments.tick;
  state.arguments.crystal = state.arguments.crystal.ahead_by(
      mote::boot_time(random_stream(state.arguments.seed, state.life + "/clock")));
  mote::gateway_lines_config lines;
  lines.lines = state.arguments.lines.size();
  for (const auto& each : state.arguments.lines)
    lines.slowness = std::max(lines.slowness, serial::slowness(each.port.baud));
  state.sink =
      mote::sink(network, state.arguments.registrar, state.arguments.duty,
                 random_stream(state.arguments.seed, state.life), own_time(self), lines, store);
  for (const auto& each : state.arguments.lines)
    state.ports.emplace_back(each.port);
  const auto handle = handle_of<sink_actor>(self);
  self->send(state.arguments.air, attach_radio{state.arguments.radio, {handle}});
  for (const auto& each : state.arguments.lines)
    self->send(each.line, attach_serial{serial::direction::to_mote, {handle}});
  for (const auto& each : state.arguments.backbones)
    self->send(each.link, attach_backbone{false, {handle}});
  perform(self, state.sink.start(own_time(self)));
  state.flows.start(self, state.arguments.apps, state.arguments.address, state.arguments.radio,
                    state.arguments.air,
                    random_stream(state.arguments.seed, state.life + "/flows"));
  return {
      [self](const frame_received& x) {
        const auto frame = radio::decode(x.psdu.view());
        if (!frame || !is_for(*frame, self->state.arguments.address))
          return;
        if (!self->state.flows.take(self, *frame))
          on_frame(self, *frame, sfd_of(x.psdu.view(), now(self)));
      },
      [self](const radio_done& x) {
        if (const auto token = token_of(x))
          perform(self, self->state.sink.on_sent(*token, x.status == radio::send_status::sent,
                                                 x.transmissions, own_time(self)));
        else
          self->state.flows.on_done(self, x);
      },
      [self](const timer_expired& x) {
        self->state.flows.on_timer(self, x);
        if (!self->state.wake.accepts(x))
          return;
        perform(self, self->state.sink.on_time(own_time(self)));
        for (std::size_t i = 0; i < self->state.ports.size(); ++i)
          perform(self, self->state.ports[i].on_time(now(self)), i);
      },
      [self](const serial_octets& x) { on_octets(self, x); },
      [self](const backbone_received& x) {
        perform(self,
                self->state.sink.on_frame(x.source, x.am_type, x.octets.view(),
                                          self->state.arguments.crystal.own(now(self) - x.age),
                                          own_time(self), network::medium::backbone));
      },
      [self](const backbone_sent& x) {
        perform(self, self->state.sink.on_sent(x.token, x.acked, 1, own_time(self)));
      },
      [self](battery_low) {
        self->send(self->state.arguments.ecology,
                   notable_event{self->path(), "sink's battery low"});
      },
      [self](battery_flat) {
        self->send(self->state.arguments.ecology,
                   notable_event{self->path(), "sink's battery flat"});
      },
      [](crash_now) { throw std::runtime_error(std::string(planned_crash)); },
      [self](const step_clock& x) {
        self->state.sink.on_clock_leapt(x.by);
        perform(self, self->state.sink.on_time(own_time(self)));
      },
      [self](const status_request& x) {
        if (x.sample > 0) {
          self->send(self->state.arguments.ecology,
                     sample_of(x.sample, status_of(self->state.arguments.address, self->state.sink,
                                                   own_time(self), now(self))));
          return;
        }
        self->state.flows.report(self, self->state.arguments.ecology);
        send_status(self, true);
      },
  };
}

} // namespace rubicon
