#include "actors/mote.hpp"

#include <stdexcept>

#include "actors/apps/mote_apps.hpp"
#include "actors/log.hpp"
#include "actors/statuses.hpp"
#include "scheduler/spawn.hpp"
#include "scheduler/supervision.hpp"

namespace rubicon {

namespace {

using mote_pointer = scheduler::traced_pointer<mote_state, mote_actor>;

void perform(mote_pointer self, mote::node_outputs todo);

struct performer {
  mote_pointer self;

  void operator()(network::transmit& x) const {
    const bool unicast = x.next_hop != broadcast_mote;
    self->send(self->state.arguments->air,
               radio_send{self->state.arguments->radio, 0, x.next_hop, x.am_type,
                          payload(std::move(x.payload)), unicast});
  }

  void operator()(const mote::membership& x) const {
    log(self, spdlog::level::info, "event={}", x.joined ? "joined" : "lost_island");
    for (const auto& app : self->state.apps)
      self->send(app, membership_changed{x.joined, x.island});
  }

  void operator()(transport::received& x) const {
    const auto owner = self->state.owners.find(x.am_type);
    if (owner == self->state.owners.end()) {
      ++self->state.unowned;
      return;
    }
    self->send(owner->second, message_received{x.source, x.am_type, payload(std::move(x.payload))});
  }

  void operator()(const transport::outcome& x) const {
    const auto found = self->state.waiting.find(x.id);
    if (found == self->state.waiting.end())
      return;
    self->send(found->second.app, send_ended{found->second.token, false, x.acked});
    self->state.waiting.erase(found);
  }
};

void perform(mote_pointer self, mote::node_outputs todo) {
  for (auto& output : todo)
    std::visit(performer{self}, output);
  self->state.wake.follow(self, self->state.node->deadline());
}

void on_frame(mote_pointer self, byte_view psdu) {
  const auto frame = radio::decode(psdu);
  if (!frame || !is_for(*frame, self->state.arguments->address) ||
      self->state.flows.take(self, *frame))
    return;
  if (const auto& node = self->state.node; node && !self->state.flat)
    perform(self, node->on_frame(frame->source, frame->am_type, frame->payload, now(self)));
}

void go(mote_pointer self) {
  auto& state = self->state;
  if (state.walk.empty())
    return;
  self->send(state.arguments->air, move_radio{state.arguments->radio, state.walk.at(now(self))});
  state.walk_wake.follow(self, state.walk.next(now(self)));
}

void on_timer(mote_pointer self, const timer_expired& x) {
  auto& state = self->state;
  state.flows.on_timer(self, x);
  if (state.wake.accepts(x) && !state.flat)
    perform(self, state.node->on_time(now(self)));
  if (state.walk_wake.accepts(x)) // a mote is carried on even if its battery is flat
    go(self);
}

void on_send(mote_pointer self, const send_message& x) {
  const auto ticket = self->state.next_ticket++;
  auto accepted = self->state.node->send(ticket, x.destination, x.am_type,
                                         to_bytes(x.octets.view()), x.reliable, now(self));
  if (accepted && x.reliable)
    self->state.waiting[ticket] = {x.app.actor, x.token};
  else
    self->send(x.app.actor, send_ended{x.token, !accepted, false});
  if (accepted)
    perform(self, *std::move(accepted));
}

void on_claim(mote_pointer self, const claim_am_type& x) {
  const auto [owner, claimed] = self->state.owners.emplace(x.am_type, x.app.actor);
  if (!claimed && owner->second != x.app.actor)
    log(self, spdlog::level::err, "event=claim_refused am_type={}", x.am_type);
}

void on_read(mote_pointer self, const read_transducers& x) {
  transducers_read answer;
  for (const auto kind : x.kinds) {
    if (const auto count = self->state.node->read(kind, now(self)))
      answer.counts.push_back(*count);
  }
  self->send(x.app.actor, std::move(answer));
}

void on_set(mote_pointer self, const set_actuator& x) {
  const bool obeyed = self->state.node->actuate(x.name, x.state);
  const auto state = self->state.node->actuator_state(x.name).value_or(0);
  if (obeyed)
    self->send(self->state.arguments->ecology,
               story{self->path(), x.name + (state == 0   ? " off"
                                             : state == 1 ? " on"
                                                          : " at " + std::to_string(state))});
  self->send(x.app.actor, actuator_changed{x.name, state, obeyed});
}

/// The MCU has stopped: no apps, no timers, no answers on the radio.
void die(mote_pointer self) {
  if (self->state.flat)
    return;
  self->state.flat = true;
  for (const auto& app : self->state.apps)
    self->send(app, membership_changed{});
  log(self, spdlog::level::info, "event=battery_flat");
  self->send(self->state.arguments->ecology, story{self->path(), "battery flat"});
  self->send(self->state.arguments->ecology, mote_flat{self->state.arguments->address});
  self->state.flows.stop(self);
}

/// @param open reliable sends still waiting for their outcome
void report_messages(mote_pointer self, const transport::endpoint_counters& counted,
                     std::size_t open) {
  const auto& arguments = *self->state.arguments;
  self->send(arguments.ecology, message_status{arguments.address.island, report_of(counted, open)});
}

/// An exception ends the mote. What this life has counted must not go with it. Reliable messages
/// that were still open have failed; nobody will know about flows' requests, so they stay open.
void report_failures(mote_pointer self) {
  self->set_exception_handler([self](caf::scheduled_actor*, std::exception_ptr& x) {
    self->state.flows.report(self, self->state.arguments->ecology);
    if (const auto& node = self->state.node) {
      auto counted = node->messages();
      counted.reliable_failed += node->outstanding();
      report_messages(self, counted, 0);
    }
    return scheduler::failure_of(x);
  });
}

void start(mote_pointer self) {
  auto& state = self->state;
  const auto& arguments = *state.arguments;
  const auto life = "mote/" + arguments.name + '#' + std::to_string(state.incarnation);
  self->send(arguments.air,
             attach_radio{arguments.radio, {caf::actor_cast<radio_user_actor>(self)}});
  state.walk = mote::walk(arguments.path, arguments.step);
  go(self);
  if (arguments.stack == config::stack::full)
    state.node = std::make_unique<mote::node>(arguments.node, state.incarnation,
                                              random_stream(arguments.seed, life));
  state.apps = spawn_mote_apps(self);
  if (state.node)
    perform(self, state.node->start(now(self)));
  state.flows.start(self, arguments.apps, arguments.address, arguments.radio, arguments.air,
                    random_stream(arguments.seed, life + "/flows"));
}

} // namespace

mote_actor::behavior_type mote_behavior(mote_pointer self,
                                        std::shared_ptr<const mote_arguments> arguments,
                                        std::uint32_t incarnation) {
  report_failures(self);
  self->state.arguments = std::move(arguments);
  self->state.incarnation = incarnation;
  start(self);
  return {
      [self](const frame_received& x) { on_frame(self, x.psdu.view()); },
      [self](const radio_done& x) { self->state.flows.on_done(self, x); },
      [self](battery_flat) { die(self); },
      [self](const claim_am_type& x) { on_claim(self, x); },
      [self](const send_message& x) {
        if (self->state.node && !self->state.flat)
          on_send(self, x);
      },
      [self](const read_transducers& x) {
        if (self->state.node && !self->state.flat)
          on_read(self, x);
      },
      [self](const set_actuator& x) {
        if (self->state.node && !self->state.flat)
          on_set(self, x);
      },
      [self](const move_mote& x) {
        self->state.walk_wake.stop();
        self->send(self->state.arguments->air, move_radio{self->state.arguments->radio, x.place});
      },
      [self](crash_now) {
        if (!self->state.flat)
          throw std::runtime_error("crash from the fault plan");
      },
      [self](end_battery) {
        self->send(self->state.arguments->air,
                   radio_power{self->state.arguments->radio, radio::power::flat});
        die(self);
      },
      [self](const timer_expired& x) { on_timer(self, x); },
      [self](status_request) {
        self->state.flows.report(self, self->state.arguments->ecology);
        if (const auto& node = self->state.node)
          report_messages(self, node->messages(), node->outstanding());
      },
  };
}

} // namespace rubicon
