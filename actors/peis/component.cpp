#include "actors/peis/component.hpp"

#include <optional>
#include <utility>
#include <variant>

#include "actors/base/log.hpp"
#include "actors/messages/common.hpp"
#include "actors/messages/peis.hpp"
#include "actors/messages/services.hpp"
#include "actors/messages/supervision.hpp"
#include "peis/tuples/meta_tuple.hpp"

namespace rubicon {

namespace {

using component_pointer = scheduler::actor_pointer<component_state, component_actor>;

struct component_performer {
  component_pointer self;

  void operator()(components::watch& x) const {
    if (x.what == components::watched::reference)
      self->state.references.insert(x.number);
    if (x.what == components::watched::target)
      send(watch_indirectly{handle(), x.number, x.owner, std::move(x.key)});
    else
      send(watch_tuples{handle(), x.number, x.owner, std::move(x.key)});
  }
  void operator()(components::publish& x) const {
    send(set_tuple{std::move(x.key), payload(std::move(x.value)), x.text});
  }
  void operator()(components::erase& x) const { send(delete_tuple{std::move(x.key)}); }
  void operator()(components::declare& x) const {
    const auto own = peis::key::parse(x.target);
    if (x.reference.empty() && own)
      x.reference = peis::format_meta(peis::meta_target{self->state.arguments.self, *own});
    send(declare_meta_tuple{std::move(x.key), std::move(x.reference)});
  }
  void operator()(components::write& x) const {
    if (x.meta)
      send(set_meta_tuple{handle(), x.token, x.owner, std::move(x.key), std::move(x.text)});
    else
      send(set_remote_tuple{handle(), x.token, x.owner, std::move(x.key),
                            payload(to_bytes(std::string_view(x.text))), true});
  }
  void operator()(components::tell& x) const {
    self->send(self->state.arguments.ecology,
               notable_event{x.who.empty() ? self->path() : std::move(x.who), std::move(x.what)});
  }

  template <class Message>
  void send(Message x) const {
    self->send(self->state.arguments.peer, std::move(x));
  }
  [[nodiscard]] peis_client_actor handle() const { return handle_of<peis_client_actor>(self); }
};

void perform(component_pointer self, components::outputs todo) {
  for (auto& output : todo)
    std::visit(component_performer{self}, output);
  self->state.wake.follow(self, self->state.arguments.core->deadline());
}

void on_tuple(component_pointer self, const tuple_event& x) {
  auto& core = *self->state.arguments.core;
  const auto text = to_string(x.value.view());
  if (!self->state.references.contains(x.watch)) {
    perform(self, core.on_tuple({x.watch, x.owner, x.key, text, x.deleted}, now(self)));
    return;
  }
  std::optional<components::tuple_name> to;
  const auto target = peis::parse_meta(text);
  if (!x.deleted && target && *target)
    to = components::tuple_name{(*target)->owner, (*target)->name.text()};
  core.on_reference(x.watch, to);
}

void send_status(component_pointer self) {
  const auto& x = self->state.arguments;
  if (auto figures = x.core->figures(); !figures.empty())
    self->send(x.ecology, program_status{{x.who, x.kind, std::move(figures)}, x.number, {}, {}});
}

} // namespace

component_actor::behavior_type component_behavior(component_pointer self,
                                                  component_arguments arguments) {
  self->set_exit_handler([self](const caf::exit_msg& x) {
    if (self->state.arguments.number > 0) // a life that a fault has ended counts as well
      send_status(self);
    self->quit(x.reason);
  });
  self->state.arguments = std::move(arguments);
  if (auto* const outside = self->state.arguments.outside)
    outside->attach([me = handle_of<component_actor>(self)] { post(me, outside_input{}); });
  perform(self, self->state.arguments.core->start(now(self)));
  return {
      [self](const timer_expired& x) {
        if (self->state.wake.accepts(x))
          perform(self, self->state.arguments.core->on_time(now(self)));
      },
      [self](outside_input) {
        if (auto* const outside = self->state.arguments.outside)
          perform(self, outside->on_input(now(self)));
      },
      [self](const tuple_event& x) { on_tuple(self, x); },
      [](const peis_message&) {}, // hooks no port
      [self](const peis_outcome& x) {
        if (!x.success)
          log(self, spdlog::level::warn, "event=write_failed cause={}", x.cause);
        if (x.token > 0)
          perform(self, self->state.arguments.core->on_written(x.token, x.cause, now(self)));
      },
      [self](status_request) { send_status(self); },
  };
}

} // namespace rubicon
