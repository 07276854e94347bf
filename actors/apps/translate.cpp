#include "actors/apps/translate.hpp"

#include "actors/timer.hpp"
#include "scheduler/supervision.hpp"

namespace rubicon {

namespace {

using translate_pointer = scheduler::traced_pointer<translate_state, peer_app_actor>;

struct performer {
  translate_pointer self;

  void operator()(const translate::publish& x) const {
    self->send(self->state.arguments.peer, set_tuple{x.key, payload(to_bytes(x.text)), true});
  }

  void operator()(const translate::erase& x) const {
    self->send(self->state.arguments.peer, delete_tuple{x.key});
  }
};

void on_tuple(translate_pointer self, const tuple_event& x) {
  auto& state = self->state.arguments;
  const bool own = x.owner == state.peer_number;
  const auto todo = x.deleted
                        ? state.core.on_gone(x.key, own)
                        : state.core.on_value(x.key, to_string(x.value.view()), own, now(self));
  for (const auto& output : todo)
    std::visit(performer{self}, output);
}

void report(translate_pointer self) {
  const auto& state = self->state.arguments;
  const auto& counted = state.core.counters();
  const auto figure = [](const char* name, std::uint64_t value) {
    return std::pair<std::string, double>(name, static_cast<double>(value));
  };
  self->send(
      state.ecology,
      program_status{
          {state.who,
           "translate",
           {figure("translated", counted.translated), figure("tuples", state.core.targets()),
            figure("bad values", counted.bad_values), figure("long values", counted.long_values),
            figure("bad keys", counted.bad_keys), figure("refused", counted.refused)}},
          0,
          {},
          {}});
}

} // namespace

peer_app_actor::behavior_type translate_behavior(translate_pointer self,
                                                 translate_arguments arguments) {
  scheduler::tell_monitors_of_exceptions(self);
  self->state.arguments = std::move(arguments);
  const auto& state = self->state.arguments;
  for (const auto& key : state.core.watched())
    self->send(state.peer,
               watch_tuples{{caf::actor_cast<peis_client_actor>(self)}, 0, any_peer, key});
  return {
      [self](const tuple_event& x) { on_tuple(self, x); },
      [](const peis_message&) {},
      [](const peis_outcome&) {},
      [self](status_request) { report(self); },
  };
}

} // namespace rubicon
