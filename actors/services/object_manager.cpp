#include "actors/services/object_manager.hpp"

#include <algorithm>

#include "actors/base/failure.hpp"
#include "actors/base/log.hpp"
#include "actors/base/statuses.hpp"
#include "actors/messages/common.hpp"
#include "actors/messages/peis.hpp"
#include "actors/messages/services.hpp"
#include "actors/messages/supervision.hpp"
#include "actors/services/object_proxy.hpp"
#include "core/tuples/interface_keys.hpp"
#include "scheduler/messages/spawn.hpp"

namespace rubicon {

namespace {

/// Pause before proxies that have ended are started again: one that fails at birth must not stop
/// time.
constexpr duration restart_delay = 1s;

using object_manager_pointer = scheduler::actor_pointer<object_manager_state, timed_peer_app_actor>;

struct object_manager_performer {
  object_manager_pointer self;

  void operator()(const proxy::start_object_proxy& x) const {
    auto& state = self->state;
    const auto* what = state.manager.classes().find(x.class_name);
    if (what == nullptr)
      return;
    proxy::object_proxy core(*what, x.percept);
    const auto name = core.prefix();
    log(self, spdlog::level::info, "event=started proxy={} class={}", name, x.class_name);
    state.proxies[{x.percept.channel, x.percept.hardware_id}] =
        scheduler::spawn_at<scheduler::monitored>(self, "proxy/" + name, object_proxy_behavior,
                                                  std::move(core), state.peer_name, state.peer,
                                                  state.ecology);
  }

  void operator()(const proxy::unknown_object& x) const {
    const auto id = x.percept.channel + '/' + x.percept.hardware_id;
    log(self, spdlog::level::warn, "event=unknown_object id={}", id);
    self->send(self->state.ecology,
               notable_event{self->path(), "object " + id + " is one that no proxy class claims"});
  }
};

void perform(object_manager_pointer self, const proxy::object_manager::outputs& todo) {
  for (const auto& output : todo)
    std::visit(object_manager_performer{self}, output);
}

void on_down(object_manager_pointer self, const caf::down_msg& x) {
  auto& state = self->state;
  const auto found = std::ranges::find_if(
      state.proxies, [&](const auto& entry) { return entry.second.address() == x.source; });
  if (found == state.proxies.end())
    return;
  log(self, spdlog::level::warn, "event=proxy_ended object={}", found->first.second);
  if (!was_asked_to_end(x.reason))
    self->send(state.ecology,
               actor_failed{"proxy of object " + found->first.second, text_of(x.reason)});
  state.ended.insert(found->first);
  state.proxies.erase(found);
  if (!state.restart_at)
    state.restart_at = now(self) + restart_delay;
  state.wake.follow(self, state.restart_at);
}

void restart(object_manager_pointer self) {
  auto& state = self->state;
  state.restart_at.reset();
  for (const auto& [channel, id] : std::exchange(state.ended, {}))
    perform(self, state.manager.on_proxy_gone({channel, id, 0}));
}

/// Classes that have become known since.
void on_classes(object_manager_pointer self) {
  auto& state = self->state;
  perform(self, state.manager.on_classes(proxy::known_at(state.classes, now(self))));
  state.classes_wake.follow(self, proxy::next_known(state.classes, now(self)));
}

void send_status(object_manager_pointer self) {
  const auto& state = self->state;
  report::cause_counts modules;
  report::add_counters<proxy::object_manager_counters>(modules, "object_manager",
                                                       state.manager.counters());
  send_modules(self, state.ecology, state.peer_name, std::move(modules));
}

} // namespace

timed_peer_app_actor::behavior_type object_manager(object_manager_pointer self,
                                                   std::vector<proxy::proxy_class> classes,
                                                   std::string peer_name, peis_peer_actor peer,
                                                   ecology_actor ecology) {
  auto& state = self->state;
  state.peer_name = std::move(peer_name);
  state.classes = std::move(classes);
  state.manager = proxy::object_manager(proxy::known_at(state.classes, now(self)));
  state.classes_wake.follow(self, proxy::next_known(state.classes, now(self)));
  state.peer = std::move(peer);
  state.ecology = std::move(ecology);
  self->set_down_handler([self](const caf::down_msg& x) { on_down(self, x); });
  self->set_exit_handler([self](const caf::exit_msg& x) {
    send_status(self);
    for (const auto& [object, handle] : self->state.proxies)
      self->send_exit(handle, x.reason); // they are of the same process
    self->quit(x.reason);
  });
  for (const auto key : {all_interface_channels_key, all_interface_objects_key})
    self->send(state.peer,
               watch_tuples{{handle_of<peis_client_actor>(self)}, 0, any_peer, std::string(key)});
  return {
      [self](const tuple_event& x) {
        perform(self, self->state.manager.on_tuple(x.owner, x.key, x.value.view(), x.deleted));
      },
      [](const peis_message&) {},
      [](const peis_outcome&) {},
      [self](status_request x) {
        send_status(self);
        for (const auto& [object, handle] : self->state.proxies)
          self->send(handle, x);
      },
      [self](const timer_expired& x) {
        if (self->state.wake.accepts(x))
          restart(self);
        else if (self->state.classes_wake.accepts(x))
          on_classes(self);
      },
  };
}

} // namespace rubicon
