#include "actors/apps/goal.hpp"

#include <optional>
#include <variant>

#include "actors/log.hpp"
#include "peis/meta_tuple.hpp"
#include "scheduler/supervision.hpp"

namespace rubicon {

namespace {

using pursuer_pointer = scheduler::traced_pointer<pursuer_state, timed_peer_app_actor>;

/// Names of watches: of the goal; and for each input, beginning with input_first, one of the tuple
/// that it is and one of its meta tuple.
constexpr std::uint64_t watch_goal = 0;
constexpr std::uint64_t input_first = 1;

struct performer {
  pursuer_pointer self;

  void operator()(const goal::publish& x) const {
    self->send(self->state.arguments.peer, set_tuple{x.key, payload(to_bytes(x.text)), true});
  }

  void operator()(const goal::declare& x) const {
    auto reference = x.reference;
    const auto own = peis::key::parse(x.target);
    if (reference.empty() && own)
      reference = peis::format_meta(peis::meta_target{self->state.arguments.peer_number, *own});
    self->send(self->state.arguments.peer, declare_meta_tuple{x.key, std::move(reference)});
  }

  void operator()(const goal::begun& x) const { tell("goal: " + x.goal); }

  void operator()(const goal::ended& x) const {
    tell(x.goal + ' ' + std::string(to_string(x.outcome)) +
         (x.cause == goal::goal_cause::none ? std::string()
                                            : ": " + std::string(to_string(x.cause))));
  }

  void tell(std::string what) const {
    const auto& arguments = self->state.arguments;
    self->send(arguments.ecology, story{arguments.core.config().name, std::move(what)});
  }
};

void perform(pursuer_pointer self, goal::outputs todo) {
  for (auto& output : todo)
    std::visit(performer{self}, output);
  self->state.wake.follow(self, self->state.arguments.core.deadline());
}

void watch_all(pursuer_pointer self) {
  const auto& x = self->state.arguments;
  const carried<peis_client_actor> client{caf::actor_cast<peis_client_actor>(self)};
  self->send(x.peer, watch_tuples{client, watch_goal, x.peer_number, x.core.goal_key()});
  for (std::size_t i = 0; i < x.core.config().inputs.size(); ++i) {
    const auto key = x.core.meta_key(i);
    self->send(x.peer, watch_tuples{client, input_first + 2 * i + 1, x.peer_number, key});
    self->send(x.peer, watch_indirectly{client, input_first + 2 * i, x.peer_number, key});
  }
}

/// An input is another tuple, or none that anybody understands.
void on_meta_tuple(pursuer_pointer self, std::size_t input, const tuple_event& x) {
  std::optional<goal::source> to;
  const auto target = peis::parse_meta(to_string(x.value.view()));
  if (!x.deleted && target && *target)
    to = goal::source{(*target)->owner, (*target)->name.text()};
  self->state.arguments.core.on_reference(input, to);
}

void on_tuple(pursuer_pointer self, const tuple_event& x) {
  auto& core = self->state.arguments.core;
  if (x.watch == watch_goal) {
    if (!x.deleted)
      perform(self, core.on_goal(to_string(x.value.view()), now(self)));
    return;
  }
  const std::size_t input = (x.watch - input_first) / 2;
  if ((x.watch - input_first) % 2 == 1)
    on_meta_tuple(self, input, x);
  else if (x.deleted)
    core.on_input_gone(input, {x.owner, x.key});
  else
    perform(self, core.on_input(input, {x.owner, x.key}, to_string(x.value.view()), now(self)));
}

void report(pursuer_pointer self) {
  const auto& x = self->state.arguments;
  const auto& counted = x.core.counters();
  const auto figure = [](std::uint64_t count) { return static_cast<double>(count); };
  self->send(x.ecology, program_status{{x.who,
                                        "goal",
                                        {{"goals", figure(counted.goals)},
                                         {"succeeded", figure(counted.succeeded)},
                                         {"failed", figure(counted.failed)},
                                         {"preempted", figure(counted.preempted)},
                                         {"timed out", figure(counted.timeouts)},
                                         {"unknown", figure(counted.unknown)},
                                         {"open", figure(x.core.open_goals())}}},
                                       0,
                                       {},
                                       {}});
}

} // namespace

timed_peer_app_actor::behavior_type pursuer_behavior(pursuer_pointer self,
                                                     pursuer_arguments arguments) {
  scheduler::tell_monitors_of_exceptions(self);
  self->state.arguments = std::move(arguments);
  perform(self, self->state.arguments.core.start(now(self)));
  watch_all(self);
  return {
      [self](const tuple_event& x) { on_tuple(self, x); },
      [](const peis_message&) {}, // hooks no port
      [](const peis_outcome&) {}, // asks nobody for anything
      [self](status_request) { report(self); },
      [self](const timer_expired& x) {
        if (self->state.wake.accepts(x))
          perform(self, self->state.arguments.core.on_time(now(self)));
      },
  };
}

} // namespace rubicon
