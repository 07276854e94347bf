#include "actors/services/object_proxy.hpp"

#include <utility>

#include "actors/base/statuses.hpp"
#include "actors/messages/common.hpp"
#include "actors/messages/peis.hpp"
#include "actors/messages/services.hpp"
#include "actors/messages/supervision.hpp"

namespace rubicon {

namespace {

using object_proxy_pointer = scheduler::actor_pointer<object_proxy_state, timed_peer_app_actor>;

void perform(object_proxy_pointer self, const proxy::object_proxy::outputs& todo) {
  for (const auto& output : todo) {
    const auto& x = std::get<proxy::publish>(output);
    self->send(self->state.peer, set_tuple{x.key, payload(to_bytes(x.text)), true});
  }
  self->state.wake.follow(self, self->state.core.deadline());
}

void send_notable(object_proxy_pointer self, std::string what) {
  self->send(self->state.ecology, notable_event{self->path(), std::move(what)});
}

void on_tuple(object_proxy_pointer self, const tuple_event& x) {
  auto& core = self->state.core;
  const auto before = core.interface_name();
  perform(self, core.on_tuple(x.owner, x.key, x.value.view(), x.deleted, now(self)));
  const auto after = core.interface_name();
  if (!after.empty() && after != before)
    send_notable(self, "seen by the reader " + after);
}

void on_time(object_proxy_pointer self) {
  auto& core = self->state.core;
  const bool was_there = core.is_active();
  perform(self, core.on_time(now(self)));
  if (was_there && !core.is_active())
    send_notable(self, "seen by no reader");
}

void send_status(object_proxy_pointer self) {
  const auto& core = self->state.core;
  report::proxy_report r;
  r.name = core.prefix();
  r.proxy_class = core.what().name;
  r.status = core.is_active() ? "active" : "lost";
  r.values.assign(core.values().begin(), core.values().end());
  self->send(self->state.ecology, proxy_status{std::move(r)});
  report::cause_counts modules;
  report::add_counters<proxy::object_counters>(modules, "object", core.counters());
  send_modules(self, self->state.ecology, self->state.peer_name, std::move(modules));
}

} // namespace

timed_peer_app_actor::behavior_type
object_proxy_behavior(object_proxy_pointer self, proxy::object_proxy core, std::string peer_name,
                      peis_peer_actor peer, ecology_actor ecology) {
  auto& state = self->state;
  state.core = std::move(core);
  state.peer_name = std::move(peer_name);
  state.peer = std::move(peer);
  state.ecology = std::move(ecology);
  perform(self, state.core.start(now(self)));
  for (auto& key : state.core.watches())
    self->send(state.peer, watch_tuples{{handle_of<peis_client_actor>(self)}, 0, any_peer, key});
  return {
      [self](const tuple_event& x) { on_tuple(self, x); },
      [](const peis_message&) {},
      [](const peis_outcome&) {},
      [self](status_request) { send_status(self); },
      [self](const timer_expired& x) {
        if (self->state.wake.accepts(x))
          on_time(self);
      },
  };
}

} // namespace rubicon
