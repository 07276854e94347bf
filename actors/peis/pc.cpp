#include "actors/peis/pc.hpp"

#include "actors/base/statuses.hpp"
#include "actors/island/program_note.hpp"
#include "actors/messages/common.hpp"
#include "actors/messages/peis.hpp"
#include "actors/messages/programs.hpp"
#include "actors/messages/services.hpp"
#include "actors/services/gateway.hpp"

namespace rubicon {

namespace {

using pc_pointer = scheduler::actor_pointer<pc_state, pc_actor>;

void perform(pc_pointer self, communication::outputs todo) {
  auto& state = self->state;
  for (auto& packet : todo) { // Transport repeats what is lost
    const acting_on its(packet.from);
    const auto [called, mote] = packet.destination;
    if (const auto meant = state.gateways.meant_by(called); meant != called)
      state.talks.note(called, meant, mote, packet.segment);
    auto x = communication::message_of(std::move(packet));
    x.peer = state.gateways.gateway_for(called);
    self->send(state.arguments.peer, send_peis_message{{handle_of<peis_client_actor>(self)},
                                                       0,
                                                       x.peer,
                                                       communication::island_message_port,
                                                       payload(std::move(x.octets)),
                                                       false});
  }
  state.programs.send_notices(self, state.arguments.ecology);
  state.separate.send_events(self);
  state.wake.follow(self, earliest(state.pc.deadline(), state.programs.deadline()));
}

/// An island speaks through whichever of its gateways leads.
peer_id source_of(pc_pointer self, const peis_message& x) {
  const auto& state = self->state;
  const auto packet = network::decode_gateway_packet(x.octets.view());
  if (!packet || x.source.value <= 0)
    return x.source;
  return gateway_of(
      state.talks.source_of(state.gateways.island_of(x.source), no_mote, packet->body));
}

void on_message(pc_pointer self, const peis_message& x) {
  auto& state = self->state;
  if (x.port == gateway::announcement_port) {
    state.gateways.on_announcement(x.source, x.octets.view(), now(self));
    static_cast<void>(
        state.gateways.on_time(now(self))); // those not received for long are forgotten
    return;
  }
  perform(self, state.pc.on_message(source_of(self, x), x.octets.view(), now(self)));
}

void on_timer(pc_pointer self) {
  auto& state = self->state;
  perform(self, state.pc.on_time(now(self)));
  perform(self, state.programs.on_time(state.pc, now(self)));
}

template <class Change>
void change_programs(pc_pointer self, Change change) {
  auto& state = self->state;
  state.pc.begin(now(self));
  change(state.separate);
  perform(self, state.pc.flush());
}

void on_attach(pc_pointer self, const attach_program& x) {
  auto& state = self->state;
  if (state.separate.contains(x.number))
    change_programs(self, [&x](auto& programs) { programs.leave(x.number); });
  state.separate.attach(self, state.pc, x, state.arguments.config.incarnation);
  perform(self, {});
}

/// @param ends its life does
void send_status(pc_pointer self, bool ends) {
  const auto& state = self->state;
  const auto& arguments = state.arguments;
  auto status =
      messages_of({island_id(static_cast<std::uint32_t>(arguments.config.self.value)), no_mote},
                  state.pc.above(), ends);
  status.is_pc = true;
  self->send(arguments.ecology, std::move(status));
  state.programs.report(self, arguments.ecology, arguments.name, now(self), ends);
  report::cause_counts modules;
  add_layer(modules, communication::totals_of(state.pc.above()));
  report::add_counters<communication::pc_counters>(modules, "pc", state.pc.counters());
  report::add_counters<communication::program_port_counters>(modules, "programs",
                                                             state.separate.counters());
  send_modules(self, arguments.ecology, arguments.name, std::move(modules));
}

} // namespace

pc_actor::behavior_type pc(pc_pointer self, pc_arguments arguments) {
  self->set_exit_handler([self](const caf::exit_msg& x) {
    send_status(self, true); // a life that a fault has ended counts as well
    self->quit(x.reason);
  });
  self->set_down_handler([self](const caf::down_msg& x) {
    if (const auto ended = self->state.separate.number_of(x.source))
      change_programs(self, [&ended](auto& programs) { programs.leave(*ended); });
  });
  auto& state = self->state;
  state.arguments = std::move(arguments);
  state.pc = communication::pc(
      state.arguments.config,
      random_stream(state.arguments.seed,
                    self->path() + '#' + std::to_string(state.arguments.config.incarnation)));
  observe_programs(self, state.pc);
  self->send(state.arguments.peer,
             hook_port{{handle_of<peis_client_actor>(self)}, communication::island_message_port});
  if (state.arguments.aliases)
    self->send(state.arguments.peer,
               hook_port{{handle_of<peis_client_actor>(self)}, gateway::announcement_port});
  self->send(state.arguments.peer, watch_clock{{handle_of<clock_watcher_actor>(self)}});
  state.programs.start(state.pc, state.arguments.programs, self->path(), state.arguments.seed,
                       state.arguments.config.incarnation > 0, now(self));
  perform(self, state.pc.start(now(self)));
  return {
      [](const tuple_event&) {},
      [self](const peis_message& x) { on_message(self, x); },
      [](const peis_outcome&) {},
      [self](const clock_changed& x) {
        perform(self, self->state.pc.on_clock(x.offset, now(self)));
      },
      [self](const attach_program& x) { on_attach(self, x); },
      [self](const program_commands& x) {
        if (self->state.separate.contains(x.number))
          change_programs(self, [&x](auto& programs) { programs.on_commands(x); });
      },
      [self](const status_request& x) {
        if (x.sample > 0)
          self->send(self->state.arguments.ecology,
                     self->state.programs.sample(x.sample, self->state.arguments.name));
        else
          send_status(self, false);
      },
      [self](const timer_expired& x) {
        if (self->state.wake.accepts(x))
          on_timer(self);
      },
  };
}

} // namespace rubicon
