#include "actors/services/proxy_manager.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "actors/base/failure.hpp"
#include "actors/base/log.hpp"
#include "actors/base/statuses.hpp"
#include "actors/messages/common.hpp"
#include "actors/messages/peis.hpp"
#include "actors/messages/programs.hpp"
#include "actors/messages/services.hpp"
#include "actors/services/proxy.hpp"
#include "scheduler/messages/spawn.hpp"

namespace rubicon {

namespace {

/// Pause before a proxy that has ended is started again: one that fails at birth must not stop
/// time.
constexpr duration proxy_restart_delay = 1s;

using proxy_manager_pointer = scheduler::actor_pointer<proxy_manager_state, proxy_manager_actor>;

std::string gateway_name(const managed_island& island, peer_id gateway) {
  const auto found = std::ranges::find(island.gateways, gateway, &managed_gateway::id);
  return found == island.gateways.end() ? std::string() : found->name;
}

proxy::proxy_identity identity_of(const proxy_manager_arguments& arguments,
                                  const mote_address& mote, peer_id gateway) {
  proxy::proxy_identity who;
  who.mote = mote;
  who.mote_name = to_string(mote.mote);
  const auto island = std::ranges::find(arguments.islands, mote.island, &managed_island::id);
  if (island == arguments.islands.end())
    return who;
  who.island_name = island->name;
  who.interface_name = gateway_name(*island, gateway);
  who.interface_place = island->sink_place;
  if (const auto name = island->mote_names.find(mote.mote); name != island->mote_names.end())
    who.mote_name = name->second;
  return who;
}

std::string name_of(const proxy::proxy_identity& who) {
  return who.island_name + '/' + who.mote_name;
}

/// Notes whose the key is; reports if the proxy of another mote has it too.
void claim_key(proxy_manager_pointer self, const std::string& prefix, const mote_address& mote) {
  auto& state = self->state;
  std::string folded = prefix;
  std::ranges::transform(folded, folded.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  const auto [held, is_new] = state.keys.emplace(folded, mote);
  const auto other = std::exchange(held->second, mote);
  if (is_new || other == mote || !state.proxies.contains(other))
    return;
  const auto name = [&](const mote_address& x) {
    return name_of(identity_of(state.arguments, x, peer_id()));
  };
  log(self, spdlog::level::warn, "event=shared_key key={} mote={} other={}", prefix,
      to_string(mote), to_string(other));
  self->send(state.arguments.ecology,
             notable_event{self->path(), "the proxies of " + name(other) + " and " + name(mote) +
                                             " have the same key, " + prefix +
                                             ": a write to it reaches both"});
}

struct proxy_manager_performer {
  proxy_manager_pointer self;

  void operator()(const proxy::start_proxy& x) const {
    auto& state = self->state;
    const auto* what = state.manager.classes().find(x.class_name);
    if (what == nullptr)
      return;
    const auto& gateways = state.gateways.at(x.mote.island);
    const auto island =
        std::ranges::find(state.arguments.islands, x.mote.island, &managed_island::id);
    proxy::proxy core(*what, identity_of(state.arguments, x.mote, gateways.current()),
                      island == state.arguments.islands.end() ? 0s : island->slack);
    const auto name = core.prefix();
    const auto layer =
        proxy::streams_of(*what).empty() ? program_node_actor() : state.arguments.layer;
    log(self, spdlog::level::info, "event=started proxy={} class={}", name, x.class_name);
    claim_key(self, name, x.mote);
    state.proxies[x.mote] = scheduler::spawn_at<scheduler::monitored>(
        self, "proxy/" + name, proxy_behavior,
        proxy_arguments{std::move(core), state.arguments.peer_number, state.arguments.peer,
                        state.arguments.ecology, gateways.gateways(), gateways.current(), layer,
                        state.arguments.peer_name});
  }

  void operator()(const proxy::stop_proxy& x) const {
    const auto found = self->state.proxies.find(x.mote);
    if (found == self->state.proxies.end())
      return;
    self->demonitor(found->second.address());
    self->send_exit(found->second, caf::exit_reason::user_shutdown);
    self->state.proxies.erase(found);
  }

  void operator()(const proxy::set_presence& x) const {
    const auto found = self->state.proxies.find(x.mote);
    if (found != self->state.proxies.end())
      self->send(found->second, mote_presence{x.presence, x.cause});
  }

  void operator()(const proxy::unknown_type& x) const {
    log(self, spdlog::level::warn, "event=unknown_type mote={} type={}", to_string(x.mote), x.type);
    self->send(self->state.arguments.ecology,
               notable_event{self->path(), "mote " + to_string(x.mote) + " is of type " +
                                               std::to_string(x.type) +
                                               ", which no proxy class claims"});
  }
};

void perform(proxy_manager_pointer self, proxy::manager::outputs todo) {
  for (auto& output : todo)
    std::visit(proxy_manager_performer{self}, output);
}

/// Watches are named by island, so that a tuple's island is known without parsing anything.
void watch_gateways(proxy_manager_pointer self, const managed_island& island) {
  std::vector<peer_id> ids;
  for (const auto& each : island.gateways)
    ids.push_back(each.id);
  if (ids.empty())
    ids.push_back(gateway_of(island.id));
  std::vector<std::string_view> keys{devices_key, all_device_types_key, all_device_statuses_key};
  if (ids.size() > 1)
    keys.push_back(device_role_key);
  for (const auto gateway : ids)
    for (const auto key : keys)
      self->send(self->state.arguments.peer, watch_tuples{{handle_of<peis_client_actor>(self)},
                                                          island.id.value,
                                                          gateway,
                                                          std::string(key)});
  self->state.gateways.emplace(island.id, proxy::gateway_choice(std::move(ids)));
}

/// Tells those of the island.
void send_gateway(proxy_manager_pointer self, island_id island, peer_id gateway) {
  const auto& islands = self->state.arguments.islands;
  const auto name = gateway_name(*std::ranges::find(islands, island, &managed_island::id), gateway);
  log(self, spdlog::level::info, "event=gateway island={} id={}", to_string(island),
      to_string(gateway));
  for (const auto& [mote, handle] : self->state.proxies)
    if (mote.island == island)
      self->send(handle, gateway_changed{gateway, name});
}

void on_tuple(proxy_manager_pointer self, const tuple_event& x) {
  const island_id island{static_cast<std::uint32_t>(x.watch)};
  auto& manager = self->state.manager;
  auto& gateways = self->state.gateways.at(island);
  const auto before = gateways.current();
  std::vector<proxy::gateway_choice::tuple_change> changes;
  if (!x.deleted)
    changes = gateways.on_tuple(x.owner, x.key, x.value.view());
  else if (x.key == devices_key)
    changes = gateways.on_list_deleted(x.owner);
  if (gateways.current() != before)
    send_gateway(self, island, gateways.current());
  for (const auto& each : changes)
    perform(self, each.deleted ? manager.on_gateway_gone(island, now(self))
                               : manager.on_gateway_tuple(island, each.key, each.value, now(self)));
}

void on_down(proxy_manager_pointer self, const caf::down_msg& x) {
  auto& proxies = self->state.proxies;
  const auto found = std::ranges::find_if(
      proxies, [&](const auto& entry) { return entry.second.address() == x.source; });
  if (found == proxies.end())
    return;
  const auto mote = found->first;
  proxies.erase(found);
  if (!was_asked_to_end(x.reason))
    self->send(self->state.arguments.ecology,
               actor_failed{"proxy of mote " + to_string(mote), text_of(x.reason)});
  log(self, spdlog::level::warn, "event=proxy_ended mote={}", to_string(mote));
  self->delayed_send(self, proxy_restart_delay, restart_proxy{mote});
}

/// Classes that have become known since.
void on_classes(proxy_manager_pointer self) {
  auto& state = self->state;
  const auto& all = state.arguments.classes;
  perform(self, state.manager.on_classes(proxy::known_at(all, now(self)), now(self)));
  state.classes_wake.follow(self, proxy::next_known(all, now(self)));
}

/// Proxies that run and those that are started from now on.
void on_change(proxy_manager_pointer self, const change_class& x) {
  auto& state = self->state;
  for (auto& each : state.arguments.classes)
    if (each.name == x.what.class_name)
      proxy::apply(x.what, each);
  on_classes(self);
  for (const auto& [mote, handle] : state.proxies)
    if (state.manager.running_class(mote) == x.what.class_name)
      self->send(handle, x);
}

void send_status(proxy_manager_pointer self) {
  report::cause_counts modules;
  report::add_counters<proxy::manager_counters>(modules, "proxy_manager",
                                                self->state.manager.counters());
  send_modules(self, self->state.arguments.ecology, self->state.arguments.peer_name,
               std::move(modules));
}

} // namespace

proxy_manager_actor::behavior_type proxy_manager(proxy_manager_pointer self,
                                                 proxy_manager_arguments arguments) {
  auto& state = self->state;
  state.arguments = std::move(arguments);
  state.manager = proxy::manager(proxy::known_at(state.arguments.classes, now(self)));
  state.classes_wake.follow(self, proxy::next_known(state.arguments.classes, now(self)));
  self->set_down_handler([self](const caf::down_msg& x) { on_down(self, x); });
  self->set_exit_handler([self](const caf::exit_msg& x) {
    send_status(self);
    for (const auto& [mote, handle] : self->state.proxies)
      self->send_exit(handle, x.reason); // they are of the same process
    self->quit(x.reason);
  });
  for (const auto& island : state.arguments.islands)
    watch_gateways(self, island);
  return {
      [self](const tuple_event& x) { on_tuple(self, x); },
      [](const peis_message&) {}, // hooks no port
      [](const peis_outcome&) {}, // asks for nothing
      [self](const restart_proxy& x) {
        perform(self, self->state.manager.on_proxy_gone(x.mote, now(self)));
      },
      [self](const change_class& x) { on_change(self, x); },
      [self](const timer_expired& x) {
        if (self->state.classes_wake.accepts(x))
          on_classes(self);
      },
      [self](status_request x) {
        send_status(self);
        for (const auto& [mote, handle] : self->state.proxies)
          self->send(handle, x);
      },
  };
}

} // namespace rubicon
