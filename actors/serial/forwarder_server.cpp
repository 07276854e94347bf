#include "actors/serial/forwarder_server.hpp"

#include <utility>
#include <variant>

#include "actors/base/log.hpp"
#include "actors/base/statuses.hpp"
#include "actors/messages/common.hpp"
#include "actors/messages/serial.hpp"
#include "actors/messages/services.hpp"
#include "actors/messages/supervision.hpp"
#include "core/text/host_port.hpp"

namespace rubicon {

namespace {

using server_pointer = scheduler::actor_pointer<forwarder_server_state, forwarder_server_actor>;

void listen(server_pointer self) {
  auto& state = self->state;
  const auto& arguments = state.arguments;
  const auto where = parse_host_port(arguments.where).value();
  const auto me = handle_of<forwarder_server_actor>(self);
  auto found =
      forwarder_clients::open(*arguments.loop, where.host, where.port,
                              {[me](std::uint64_t client, bytes packet) {
                                 post(me, serial_packet{client, payload(std::move(packet))});
                               },
                               [ecology = arguments.ecology, who = self->path()](std::string what) {
                                 post(ecology, notable_event{who, std::move(what)});
                               }},
                              arguments.networks);
  if (auto* why = std::get_if<std::string>(&found))
    self->send(arguments.ecology, request_unmet{self->path(), std::move(*why)});
  else
    state.clients = std::get<std::unique_ptr<forwarder_clients>>(std::move(found));
}

void on_packet(server_pointer self, const serial_packet& x) {
  auto& state = self->state;
  if (!state.clients)
    return;
  if (x.token == 0)
    state.clients->forward(x.octets.view());
  else if (state.sink)
    self->send(state.sink, x);
  else
    state.clients->done(x.token);
}

void send_status(server_pointer self) {
  const auto& state = self->state;
  if (!state.clients)
    return;
  const auto& counted = state.clients->counters();
  serial_status status{state.arguments.island, {}};
  report::add_counters<forwarder_counters>(status.serial.lost, "forwarder_clients", counted);
  self->send(state.arguments.ecology, std::move(status));
}

} // namespace

forwarder_server_actor::behavior_type forwarder_server(server_pointer self,
                                                       forwarder_server_arguments arguments) {
  self->state.arguments = std::move(arguments);
  listen(self);
  return {
      [self](const attach_packets& x) { self->state.sink = x.user; },
      [self](const serial_packet& x) { on_packet(self, x); },
      [self](const serial_packet_done& x) {
        if (self->state.clients)
          self->state.clients->done(x.token);
      },
      [self](status_request) { send_status(self); },
  };
}

} // namespace rubicon
