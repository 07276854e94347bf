#include "actors/services/gateway.hpp"

#include <utility>

#include "actors/base/log.hpp"
#include "actors/island/program_note.hpp"
#include "actors/messages/common.hpp"
#include "actors/messages/peis.hpp"
#include "actors/messages/serial.hpp"
#include "actors/messages/services.hpp"
#include "actors/messages/supervision.hpp"
#include "actors/services/gateway_report.hpp"
#include "core/tuples/device_keys.hpp"
#include "network/am.hpp"
#include "serial/packet.hpp"
#include "serial/raw_packet.hpp"

namespace rubicon {

namespace {

/// What a gateway watches: own tuples that others write.
constexpr std::uint64_t own_watch = 1;
constexpr std::string_view written_by_others[] = {"devices.*.input.*", "devices.*.output.*.period"};

void perform(gateway_pointer self, gateway::outputs todo);
void perform(gateway_pointer self, serial::outputs todo);
void perform_real(gateway_pointer self, serial::outputs todo);
void follow(gateway_pointer self);

/// What the gateway writes is at the line when the adapter has it.
template <class Message>
void to_adapter(gateway_pointer self, Message x) {
  const auto& arguments = self->state.arguments;
  if (arguments.line_is_real)
    self->send(arguments.line, std::move(x));
  else
    self->delayed_send(arguments.line, arguments.port.latency, std::move(x));
}

struct gateway_performer {
  gateway_pointer self;
  bool is_real = false; ///< outputs of the port at the line to real motes

  // what the gateway's core wants

  void operator()(gateway::publish& x) const {
    self->send(self->state.arguments.peer,
               set_tuple{std::move(x.key), payload(std::move(x.value)), x.text});
  }

  void operator()(gateway::erase& x) const {
    self->send(self->state.arguments.peer, delete_tuple{std::move(x.key)});
  }

  void operator()(gateway::to_sink& x) const {
    const acting_on its(x.from);
    serial::am_packet packet{x.mote.value, 0, static_cast<std::uint8_t>(island().value), x.am_type,
                             std::move(x.payload)};
    perform(self, self->state.port.send(serial::packet_id{self->state.next_packet++},
                                        serial::encode(packet), now(self)));
  }

  void operator()(gateway::answer_sink& x) const {
    auto& port = self->state.port;
    if (auto* time = std::get_if<network::time_answer>(&x.answer))
      time->held = std::chrono::floor<std::chrono::microseconds>(port.wait(now(self)));
    const serial::am_packet packet{broadcast_mote.value, 0,
                                   static_cast<std::uint8_t>(island().value),
                                   network::am::sink_event, network::encode(x.answer)};
    perform(self, port.send_urgent(serial::encode(packet), now(self)));
  }

  void operator()(const gateway::to_plain& x) const {
    const acting_on its(x.from);
    auto& state = self->state;
    auto packet = state.plain.on_input(x.mote, x.channel, x.octets);
    if (!packet) {
      perform(self, state.gateway.on_plain_done(x.number, false, now(self)));
      return;
    }
    const serial::packet_id id{state.next_packet++};
    state.inputs[id] = x.number;
    if (state.arguments.real_line)
      perform_real(self, state.real_port.send(id, *std::move(packet), now(self)));
    else
      perform(self, state.port.send(id, *std::move(packet), now(self)));
  }

  void operator()(gateway::to_gateway& x) const {
    const acting_on its(x.from);
    self->send(self->state.arguments.peer,
               send_peis_message{{handle_of<peis_client_actor>(self)},
                                 static_cast<std::uint64_t>(x.peer.value), // as the outcome's token
                                 x.peer,
                                 communication::island_message_port,
                                 payload(std::move(x.octets)),
                                 x.reliable});
  }

  void operator()(gateway::relay_to& x) const {
    self->send(self->state.arguments.peer,
               send_peis_message{{handle_of<peis_client_actor>(self)},
                                 static_cast<std::uint64_t>(x.peer.value), // as the outcome's token
                                 x.peer,
                                 gateway::relay_port,
                                 payload(std::move(x.octets)),
                                 true});
  }

  void operator()(const gateway::lead_changed& x) const {
    log(self, spdlog::level::info, "event={} term={}", x.leads ? "leads" : "stands_by", x.term);
    self->send(self->state.arguments.ecology,
               notable_event{"gateway/" + self->state.arguments.name,
                             (x.leads ? "leads island " : "no longer leads island ") +
                                 to_string(island()) +
                                 (x.leads ? ", term " + std::to_string(x.term) : std::string())});
  }

  void operator()(gateway::announce& x) const {
    self->send(self->state.arguments.peer,
               broadcast_peis_message{gateway::announcement_port, payload(std::move(x.octets))});
  }

  void operator()(const gateway::member_changed& x) const {
    const mote_address mote{island(), x.mote};
    log(self, spdlog::level::info, "event={} mote={} incarnation={}",
        x.listed ? "listed" : "unlisted", to_string(mote), x.incarnation);
    self->send(self->state.arguments.ecology,
               listing_changed{mote, x.listed, x.incarnation, x.cause});
  }

  void operator()(const gateway::line_changed& x) const {
    log(self, x.up ? spdlog::level::info : spdlog::level::warn, "event={}",
        x.up ? "line_up" : "line_silent");
    if (!x.up)
      self->send(self->state.arguments.ecology,
                 notable_event{self->path(), "receives nothing from its sink"});
    else if (x.silence > duration{})
      self->send(
          self->state.arguments.ecology,
          notable_event{self->path(), "receives from its sink again, after " + to_text(x.silence)});
  }

  // what the serial port wants

  void operator()(serial::to_line& x) const {
    const acting_on its(x.from);
    serial_write write{serial::direction::to_mote, payload(std::move(x.octets))};
    if (is_real)
      self->send(self->state.arguments.real_line, std::move(write));
    else
      to_adapter(self, std::move(write));
  }

  void operator()(const serial::received& x) const {
    auto& state = self->state;
    const bool may_be_plain = is_real || !state.arguments.real_line;
    auto plain = may_be_plain ? state.plain.on_packet(x.packet, now(self)) : std::nullopt;
    if (state.arguments.forwarder && (plain || !is_real))
      self->send(state.arguments.forwarder, serial_packet{0, payload(x.packet)});
    if (plain)
      take(*plain);
    else if (is_real)
      return;
    else if (const auto packet = serial::decode_am_packet(x.packet))
      take(*packet);
    else if (!serial::decode_any_packet(x.packet) && !serial::decode_raw_packet(x.packet))
      ++state.bad_packets;
  }

  void operator()(const serial::sent& x) const {
    report_done(x.id);
    if (const auto input = self->state.inputs.extract(x.id); !input.empty()) {
      self->state.plain.on_sent();
      perform(self, self->state.gateway.on_plain_done(input.mapped(), true, now(self)));
    }
  }

  void operator()(const serial::lost& x) const {
    report_done(x.id);
    if (const auto input = self->state.inputs.extract(x.id); !input.empty()) {
      self->state.plain.on_lost(x.cause);
      perform(self, self->state.gateway.on_plain_done(input.mapped(), false, now(self)));
    }
    log(self, spdlog::level::warn, "event=lost packet={}", x.id.value);
    if (x.cause == serial::lost_cause::too_long)
      report_refused();
  }

  /// Once: who writes one such packet writes others.
  void report_refused() const {
    auto& state = self->state;
    if (std::exchange(state.has_refused, true))
      return;
    const auto most = (is_real ? state.real_port : state.port).payload_max();
    self->send(
        state.arguments.ecology,
        notable_event{
            self->path(),
            "refuses packets with more than " + std::to_string(most) +
                " octets of payload: a BaseStation would accept nothing after one (`payload`)"});
  }

  /// Of the sink.
  void take(const serial::am_packet& x) const {
    auto& state = self->state;
    perform(self, state.gateway.on_packet(mote_id(x.source), x.am_type, x.payload, now(self)));
    if (state.arguments.may_be_own_sink && state.gateway.sink().has_own_sink())
      state.port.set_payload_max(serial::am_payload_max);
  }

  /// What a sink would have said.
  void take(const std::vector<gateway::sink_packet>& all) const {
    for (const auto& x : all)
      perform(self, self->state.gateway.on_plain_packet(x, now(self)));
    if (all.empty())
      follow(self);
  }

  /// Whoever has sent a packet beside the gateway sends the next one only then.
  void report_done(serial::packet_id x) const {
    const auto found = self->state.foreign.find(x);
    if (found == self->state.foreign.end())
      return;
    self->send(self->state.arguments.forwarder, serial_packet_done{found->second});
    self->state.foreign.erase(found);
  }

  [[nodiscard]] island_id island() const { return self->state.arguments.config.island; }
};

void follow(gateway_pointer self) {
  const auto& state = self->state;
  const auto due = earliest(earliest(state.gateway.deadline(), state.plain.deadline()),
                            state.programs.deadline());
  const auto port_due = earliest(state.port.deadline(), state.real_port.deadline());
  self->state.wake.follow(self, earliest(due, port_due));
}

void perform(gateway_pointer self, gateway::outputs todo) {
  for (auto& output : todo)
    std::visit(gateway_performer{self}, output);
  self->state.programs.send_notices(self, self->state.arguments.ecology);
  follow(self);
}

void perform(gateway_pointer self, serial::outputs todo) {
  for (auto& output : todo)
    std::visit(gateway_performer{self}, output);
  follow(self);
}

void perform_real(gateway_pointer self, serial::outputs todo) {
  for (auto& output : todo)
    std::visit(gateway_performer{self, true}, output);
  follow(self);
}

/// Whether it is for a mote at the line to real ones.
bool is_for_real(gateway_pointer self, byte_view packet) {
  const auto& arguments = self->state.arguments;
  if (!arguments.real_line || !arguments.plain.range)
    return false;
  const auto x = serial::decode_any_packet(packet);
  return x && arguments.plain.range->has(mote_id(x->destination));
}

/// A packet of a program of TinyOS.
void on_foreign(gateway_pointer self, const serial_packet& x) {
  auto& state = self->state;
  const serial::packet_id id{state.next_packet++};
  state.foreign[id] = x.token;
  auto packet = to_bytes(x.octets.view());
  if (is_for_real(self, packet))
    perform_real(self, state.real_port.send(id, std::move(packet), now(self)));
  else
    perform(self, state.port.send(id, std::move(packet), now(self)));
}

/// What is at the far end of the line to plain motes is there, or not.
void on_presence(gateway_pointer self, bool there) {
  auto& state = self->state;
  state.plain.on_presence(there, now(self));
  if (there)
    follow(self);
  else
    perform(self, state.gateway.on_plain_line_lost(now(self)));
}

void on_tuple(gateway_pointer self, const tuple_event& x) {
  if (x.deleted)
    return;
  const auto key = parse_device_key(x.key);
  if (key && key->what == device_tuple::input)
    perform(self, self->state.gateway.on_input(key->mote, key->channel, x.value.view(), now(self)));
  else if (key && key->what == device_tuple::output_period)
    self->state.gateway.on_period(key->mote, key->channel, to_string(x.value.view()), now(self));
  follow(self);
}

void on_message(gateway_pointer self, const peis_message& x) {
  perform(self, self->state.gateway.on_message(x.source, x.port, x.octets.view(), now(self)));
}

void on_timer(gateway_pointer self) {
  auto& state = self->state;
  gateway_performer{self}.take(state.plain.on_time(now(self)));
  perform(self, state.gateway.on_time(now(self)));
  perform(self, state.programs.on_time(state.gateway, now(self)));
  perform(self, state.port.on_time(now(self)));
  perform_real(self, state.real_port.on_time(now(self)));
}

} // namespace

gateway_actor::behavior_type gateway_behavior(gateway_pointer self, gateway_arguments arguments) {
  self->set_exit_handler([self](const caf::exit_msg& x) {
    report_end(self); // a life that a fault has ended counts as well
    self->quit(x.reason);
  });
  auto& state = self->state;
  state.arguments = std::move(arguments);
  state.gateway =
      gateway::gateway(state.arguments.config, random_stream(state.arguments.seed, self->path()));
  observe_programs(self, state.gateway);
  state.plain = gateway::plain_line(state.arguments.plain);
  state.port = serial::host_port(state.arguments.port);
  state.real_port = serial::host_port(state.arguments.real_port);
  const auto client = handle_of<peis_client_actor>(self);
  to_adapter(self, attach_serial{serial::direction::to_pc, {handle_of<serial_end_actor>(self)}});
  if (!state.arguments.plain.motes.rules.empty()) {
    const watch_line watch{{handle_of<line_watcher_actor>(self)},
                           state.arguments.real_line != nullptr};
    if (state.arguments.real_line)
      self->send(state.arguments.real_line, watch);
    else
      to_adapter(self, watch);
  }
  if (state.arguments.forwarder)
    self->send(state.arguments.forwarder, attach_packets{{handle_of<packet_end_actor>(self)}});
  std::vector<std::uint16_t> ports{gateway::announcement_port, communication::island_message_port};
  if (!state.gateway.lead().alone())
    ports.push_back(gateway::relay_port);
  for (const auto port : ports)
    self->send(state.arguments.peer, hook_port{{client}, port});
  for (const auto key : written_by_others)
    self->send(state.arguments.peer,
               watch_tuples{{client}, own_watch, id_of(self), std::string(key)});
  self->send(state.arguments.peer, watch_subscribers{{handle_of<subscribers_watcher_actor>(self)},
                                                     std::string(devices_key)});
  self->send(state.arguments.peer, watch_clock{{handle_of<clock_watcher_actor>(self)}});
  state.programs.start(state.gateway, state.arguments.programs, self->path(), state.arguments.seed,
                       state.arguments.config.incarnation > 0, now(self));
  perform(self, state.gateway.start(now(self)));
  return {
      [self](const serial_octets& x) {
        perform(self, self->state.port.on_bytes(x.octets.view(), now(self)));
      },
      [self](const serial_packet& x) { on_foreign(self, x); },
      [self](const real_octets& x) {
        perform_real(self, self->state.real_port.on_bytes(x.octets.view(), now(self)));
      },
      [self](const serial_presence& x) { on_presence(self, x.there); },
      [self](const timer_expired& x) {
        if (self->state.wake.accepts(x))
          on_timer(self);
      },
      [self](const tuple_event& x) { on_tuple(self, x); },
      [self](const peis_message& x) { on_message(self, x); },
      [self](const peis_outcome& x) {
        if (x.success)
          return;
        ++self->state.messages_lost;
        self->state.gateway.on_unreachable(peer_id{static_cast<std::int32_t>(x.token)});
      },
      [self](const subscribers_changed& x) {
        self->state.gateway.on_subscribers(x.keys, now(self));
        follow(self);
      },
      [self](const clock_changed& x) {
        perform(self, self->state.gateway.on_clock(x.offset, now(self)));
      },
      [self](const status_request& x) {
        if (x.sample > 0) {
          self->send(self->state.arguments.ecology,
                     self->state.programs.sample(x.sample, self->state.arguments.name));
          return;
        }
        report_gateway(self);
      },
  };
}

} // namespace rubicon
