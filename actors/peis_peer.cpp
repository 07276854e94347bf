#include "actors/peis_peer.hpp"

#include "actors/log.hpp"
#include "scheduler/supervision.hpp"

namespace rubicon {

namespace {

using peer_pointer = scheduler::traced_pointer<peis_peer_state, peis_peer_actor>;

/// A value as components see it: text without its trailing NUL.
payload shown(const peis::tuple& x) {
  if (x.form != peis::encoding::text)
    return x.value;
  return payload(to_bytes(x.text()));
}

peis::tuple_content content_of(const payload& value, bool text) {
  return text ? peis::text_content(to_string(value.view())) : peis::binary_content(value);
}

void perform(peer_pointer self, peis::outputs todo);

struct performer {
  peer_pointer self;

  void operator()(peis::to_link& x) const {
    const auto found = self->state.links.find(x.link);
    if (found != self->state.links.end())
      self->delayed_send(found->second, inproc_delay,
                         link_octets{x.link.value, std::move(x.octets)});
  }

  void operator()(const peis::close_link& x) const {
    const auto found = self->state.links.find(x.link);
    if (found == self->state.links.end())
      return;
    log(self, spdlog::level::warn, "event=link_closed link={} cause={}", x.link.value,
        peis::to_string(x.why));
    self->delayed_send(found->second, inproc_delay, link_closed{x.link.value});
    self->state.links.erase(found);
  }

  void operator()(const peis::connect_to&) const {}
  void operator()(const peis::announce&) const {}

  void operator()(const peis::tuple_changed& x) const { tell(x.subscription, x.content, false); }
  void operator()(const peis::tuple_deleted& x) const { tell(x.subscription, x.content, true); }

  void operator()(peis::message& x) const {
    const auto found = self->state.ports.find(x.port);
    if (found != self->state.ports.end())
      self->send(found->second, peis_message{x.source, x.port, std::move(x.octets)});
  }

  void operator()(const peis::outcome& x) const {
    const auto found = self->state.requests.find(x.request);
    if (found == self->state.requests.end())
      return;
    self->send(found->second.client,
               peis_outcome{found->second.name, x.success,
                            x.success ? std::string() : std::string(peis::to_string(x.why))});
    self->state.requests.erase(found);
  }

  void operator()(const peis::host_appeared& x) const {
    log(self, spdlog::level::info, "event=host_appeared host={}", x.host.value);
  }
  void operator()(const peis::host_vanished& x) const {
    log(self, spdlog::level::info, "event=host_vanished host={}", x.host.value);
  }
  void operator()(const peis::quit_requested& x) const {
    log(self, spdlog::level::info, "event=quit_requested by={}", x.by.value);
    perform(self, self->state.kernel.leave(now(self)));
    for (const auto& [link, other] : self->state.links)
      self->delayed_send(other, inproc_delay, link_closed{link.value});
    self->quit(caf::exit_reason::user_shutdown);
  }

  void tell(peis::subscription_id subscription, const peis::tuple& x, bool deleted) const {
    const auto found = self->state.watches.find(subscription);
    if (found != self->state.watches.end())
      self->send(found->second.client,
                 tuple_event{found->second.name, x.owner, x.name.text(), shown(x), deleted});
  }
};

void perform(peer_pointer self, peis::outputs todo) {
  for (auto& output : todo)
    std::visit(performer{self}, output);
  self->state.wake.follow(self, self->state.kernel.deadline());
}

void know(peer_pointer self, const peis_client_actor& client) {
  if (self->state.clients.insert(client.address()).second)
    self->monitor(client);
}

/// A component has ended: nobody is to hear of its watches, requests and ports any more.
void forget(peer_pointer self, const caf::actor_addr& client) {
  auto& state = self->state;
  state.clients.erase(client);
  std::erase_if(state.ports, [&](const auto& x) { return x.second.address() == client; });
  std::erase_if(state.requests, [&](const auto& x) { return x.second.client.address() == client; });
  for (auto x = state.watches.begin(); x != state.watches.end();) {
    if (x->second.client.address() != client) {
      ++x;
      continue;
    }
    const auto subscription = x->first;
    x = state.watches.erase(x);
    perform(self, state.kernel.unsubscribe(subscription, now(self)));
  }
}

peis::request_id remember(peer_pointer self, const carried<peis_client_actor>& client,
                          std::uint64_t token) {
  know(self, client.actor);
  const peis::request_id request{self->state.next_request++};
  self->state.requests[request] = {client.actor, token};
  return request;
}

void on_watch(peer_pointer self, const watch_tuples& x) {
  know(self, x.client.actor);
  const peis::subscription_id id{self->state.next_watch++};
  self->state.watches[id] = {x.client.actor, x.watch};
  perform(self, self->state.kernel.subscribe(x.owner, x.key, id, now(self)));
}

void on_hook(peer_pointer self, const hook_port& x) {
  const auto hooked = self->state.ports.find(x.port);
  const bool free = hooked == self->state.ports.end() || hooked->second == x.client.actor;
  know(self, x.client.actor);
  if (free && self->state.kernel.hook_port(x.port))
    self->state.ports[x.port] = x.client.actor;
  else
    log(self, spdlog::level::err, "event=hook_refused port={}", x.port);
}

void report(peer_pointer self) {
  const auto& state = self->state;
  const auto counted = state.kernel.counters().network;
  peer_status status;
  auto& peer = status.peer;
  peer.id = state.kernel.id();
  peer.name = state.arguments.name;
  peer.links = state.links.size();
  peer.hosts_known = state.kernel.hosts().size();
  peer.tuples = state.kernel.own_tuples().size();
  peer.peis.packages = counted.packages_sent;
  peer.peis.tuples = peer.tuples;
  peer.peis.lost = {
      {"queue_full", counted.queue_full},   {"early_drop", counted.early_drop},
      {"no_route", counted.no_route},       {"hops", counted.hops},
      {"queued_lost", counted.queued_lost}, {"illegal", counted.illegal},
      {"malformed", counted.malformed},     {"incomplete", counted.messages_incomplete}};
  self->send(state.arguments.ecology, std::move(status));
}

void on_opened(peer_pointer self, const link_opened& x) {
  self->state.links[peis::link_id{x.link}] = x.other.actor;
  perform(self, self->state.kernel.on_link_open(peis::link_id{x.link},
                                                x.initiator ? peis::link_role::initiator
                                                            : peis::link_role::acceptor,
                                                now(self)));
}

} // namespace

peis_peer_actor::behavior_type peis_peer(peer_pointer self, peis_peer_arguments arguments) {
  scheduler::tell_monitors_of_exceptions(self);
  self->set_down_handler([self](const caf::down_msg& x) { forget(self, x.source); });
  self->state.arguments = std::move(arguments);
  self->state.kernel =
      peis::kernel(self->state.arguments.config,
                   random_stream(self->state.arguments.seed, self->path()), now(self));
  self->state.wake.follow(self, self->state.kernel.deadline());
  return {
      [self](const link_octets& x) {
        perform(self, self->state.kernel.on_link_octets(peis::link_id{x.link}, x.octets.view(),
                                                        now(self)));
      },
      [self](const link_closed& x) {
        self->state.links.erase(peis::link_id{x.link});
        perform(self, self->state.kernel.on_link_closed(peis::link_id{x.link}, now(self)));
      },
      [self](const link_opened& x) { on_opened(self, x); },
      [self](const set_tuple& x) {
        perform(self, self->state.kernel.set_tuple(x.key, content_of(x.value, x.text), now(self)));
      },
      [self](const delete_tuple& x) {
        perform(self, self->state.kernel.delete_tuple(x.key, now(self)));
      },
      [self](const set_remote_tuple& x) {
        const auto request = remember(self, x.client, x.token);
        perform(self, self->state.kernel.set_remote_tuple(
                          x.owner, x.key, content_of(x.value, x.text), request, now(self)));
      },
      [self](const watch_tuples& x) { on_watch(self, x); },
      [self](const hook_port& x) { on_hook(self, x); },
      [self](const send_peis_message& x) {
        const auto request = remember(self, x.client, x.token);
        perform(self, self->state.kernel.send_message(x.destination, x.port, x.octets, x.reliable,
                                                      peis::priority::normal, request, now(self)));
      },
      [self](const timer_expired& x) {
        if (self->state.wake.accepts(x))
          perform(self, self->state.kernel.on_time(now(self)));
      },
      [self](status_request) { report(self); },
  };
}

} // namespace rubicon
