#include "actors/peis/peis_peer.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "actors/base/log.hpp"
#include "actors/messages/common.hpp"
#include "actors/messages/links.hpp"
#include "actors/messages/peis.hpp"
#include "actors/messages/services.hpp"
#include "actors/messages/supervision.hpp"

namespace rubicon {

namespace {

peis::tuple_content content_of(const payload& value, bool text) {
  return text ? peis::text_content(to_string(value.view())) : peis::binary_content(value);
}

/// The number of a component, which is monitored from now on.
template <class Handle>
peis::client_id known(peer_pointer self, const Handle& client) {
  const peis::client_id id{client.id()};
  if (self->state.components.try_emplace(id, client.strong()).second)
    self->monitor(client);
  return id;
}

void forget(peer_pointer self, const caf::actor_addr& gone) {
  auto& state = self->state;
  const peis::client_id id{gone.id()};
  state.components.erase(id);
  if (state.init && state.init.address() == gone)
    state.init = nullptr;
  notify_components(self, state.clients.forget(id));
}

peis::tuple_content reference_content(const std::string& reference) {
  const auto target = peis::parse_meta(reference);
  assert(target); // our own programs write references as format_meta() does
  return peis::meta_content(*target);
}

/// @param rate_bps of a simulated link
void on_opened(peer_pointer self, const link_opened& x, std::uint64_t rate_bps) {
  auto& state = self->state;
  const peis::link_id id{x.link};
  if (state.left)
    return;
  const auto role = x.initiator ? peis::link_role::initiator : peis::link_role::acceptor;
  if (x.link >= first_real_link) {
    state.tcp_links.insert(id);
    self->send(state.arguments.ecology, outside_link_changed{});
  } else
    state.links[id] = {
        x.other, peis::simulated_link(role, x.condition, state.arguments.network.delay, rate_bps)};
  const auto attempt = x.attempt == 0 ? std::nullopt : std::optional(peis::attempt_id{x.attempt});
  perform_outputs(self, state.kernel.on_link_open(id, role, now(self), attempt));
}

/// Serves what has come while the kernel does not stand still.
struct server {
  peer_pointer self;
  peis_peer_state& state = self->state;
  instant at = now(self);

  void operator()(const link_octets& x) const {
    const peis::link_id link{x.link};
    perform_outputs(self, state.kernel.on_link_octets(link, x.octets.view(), at));
    if (x.link >= first_real_link && state.real != nullptr)
      state.real->on_taken(link);
  }
  void operator()(const link_closed& x) const {
    const peis::link_id id{x.link};
    const bool was_outside = state.tcp_links.erase(id) > 0;
    if (was_outside)
      self->send(state.arguments.ecology, outside_link_changed{});
    if (was_outside || state.links.erase(id) > 0)
      ++state.links_closed["far_end"];
    perform_outputs(self, state.kernel.on_link_closed(id, at));
  }
  void operator()(const link_opened& x) const {
    on_opened(self, x, state.arguments.network.bandwidth_bps);
  }
  void operator()(const bluetooth_opened& x) const { on_opened(self, x.link, x.rate_bps); }
  void operator()(const bluetooth_seen& x) const {
    perform_outputs(self, state.kernel.on_bluetooth_scan(x.adapter, x.devices, at));
  }
  /// Answers that we are a peer; the question says who asks.
  void operator()(const hello_arrived& x) const {
    if (state.left)
      return;
    perform_outputs(self, state.kernel.on_hello(x.question.octets.view(), at));
    self->delayed_send(
        x.sender, state.arguments.network.delay,
        hello_answer{x.question.adapter, x.question.device, state.kernel.network().own.hello()});
  }
  void operator()(const real_hello& x) const {
    if (state.left || state.real == nullptr)
      return;
    perform_outputs(self, state.kernel.on_hello(x.octets.view(), at));
    state.real->answer_hello(x.connection, state.kernel.network().own.hello());
  }
  void operator()(const hello_answer& x) const {
    perform_outputs(self, state.kernel.on_hello_answer(x.adapter, x.device, x.octets.view(), at));
  }
  void operator()(const attempt_failed& x) const {
    perform_outputs(self, state.kernel.on_attempt_failed(peis::attempt_id{x.attempt}, at));
  }
  void operator()(const announcement& x) const {
    const bool has_address = x.from != ipv4_address{};
    perform_outputs(
        self, state.kernel.on_announcement(x.octets.view(), at,
                                           has_address ? std::optional(x.from) : std::nullopt));
  }
  /// Those of simulated links stay.
  void operator()(addresses_changed /*x*/) const {
    if (!state.real)
      return;
    auto& all = state.arguments.config.network.addresses;
    std::erase_if(all, [&](const auto& each) {
      using kind = peis::low_level_address::kind;
      const bool is_adapter =
          each.type == kind::bluetooth && !state.arguments.real->adapter.empty();
      return each.type == kind::tcp_ipv4 || each.type == kind::udp_ipv4 || is_adapter;
    });
    for (auto& each : state.real->addresses())
      all.push_back(std::move(each));
    perform_outputs(self, state.kernel.set_addresses(all, at));
  }
  void operator()(const link_sent& x) const {
    perform_outputs(self, state.kernel.on_link_sent(peis::link_id{x.link}, x.octets, at));
  }
  void operator()(const set_tuple& x) const {
    perform_outputs(self, state.kernel.tuples().set(x.key, content_of(x.value, x.text), at));
  }
  void operator()(const delete_tuple& x) const {
    perform_outputs(self, state.kernel.tuples().remove(x.key, at));
  }
  void operator()(const set_remote_tuple& x) const {
    const auto request = state.clients.request(known(self, x.client), x.token);
    perform_outputs(self, state.kernel.tuples().set_remote(
                              x.owner, x.key, content_of(x.value, x.text), request, at));
  }
  void operator()(const watch_tuples& x) const {
    const auto watch = state.clients.watch(known(self, x.client), x.watch);
    perform_outputs(self, state.kernel.subscriptions().subscribe(x.owner, x.key, watch, at));
  }
  void operator()(const watch_indirectly& x) const {
    const auto watch = state.clients.watch(known(self, x.client), x.watch);
    perform_outputs(self,
                    state.kernel.subscriptions().subscribe_indirectly(x.owner, x.key, watch, at));
  }
  void operator()(const declare_meta_tuple& x) const {
    auto& kernel = state.kernel;
    if (!kernel.meta_tuples().is_meta_tuple(kernel.id(), x.key))
      perform_outputs(self, kernel.tuples().set(x.key, reference_content(x.reference), at));
  }
  void operator()(const set_meta_tuple& x) const {
    const auto request = state.clients.request(known(self, x.client), x.token);
    perform_outputs(self, state.kernel.tuples().set_remote(
                              x.owner, x.key, reference_content(x.reference), request, at));
  }
  void operator()(const watch_subscribers& x) const {
    const auto who = known(self, x.watcher);
    notify_components(self, state.clients.watch_subscribers(who, x.first_part, state.kernel, at));
  }
  void operator()(const watch_clock& x) const {
    notify_components(self, state.clients.watch_clock(known(self, x.watcher), state.kernel));
  }
  void operator()(const hook_port& x) const {
    const auto who = known(self, x.client);
    if (!state.kernel.messages().hook_port(x.port) || !state.clients.hook(who, x.port))
      log(self, spdlog::level::err, "event=hook_refused port={}", x.port);
  }
  void operator()(const send_peis_message& x) const {
    const auto request = state.clients.request(known(self, x.client), x.token);
    perform_outputs(self, state.kernel.messages().send(x.destination, x.port, x.octets, x.reliable,
                                                       peis::priority::normal, request, at));
  }
  void operator()(const broadcast_peis_message& x) const {
    perform_outputs(self,
                    state.kernel.messages().broadcast(x.port, x.octets, peis::no_request, at));
  }
  void operator()(const step_clock& x) const {
    perform_outputs(self, state.kernel.step_clock(x.by, at));
  }
  void operator()(quit_peer) const { quit_process(self); }
  void operator()(const timer_expired& x) const {
    if (state.wake.accepts(x))
      perform_outputs(self, state.kernel.on_time(at));
  }
};

void lose_held(peer_pointer self) {
  ++self->state.held_lost;
  note_loss(loss::gateway_stopped);
}

template <class Message>
auto served(peer_pointer self) {
  return [self](const Message& x) {
    auto& state = self->state;
    if (!state.paused)
      server{self}(x);
    else if (state.held.size() < held_max)
      state.held.emplace_back([self, x, from = provenance()] {
        const acting_on its(from);
        server{self}(x);
      });
    else
      lose_held(self);
  };
}

// What is done at once.

void on_pause(peer_pointer self, const pause_peer& x) {
  if (std::exchange(self->state.paused, true))
    return;
  self->send(self->state.arguments.ecology, notable_event{self->path(), "paused"});
  self->delayed_send(self, x.length, resume_peer{});
}

void on_resume(peer_pointer self) {
  self->state.paused = false;
  self->send(self->state.arguments.ecology, notable_event{self->path(), "goes on"});
  for (const auto& serve : std::exchange(self->state.held, {}))
    serve();
}

void on_condition(peer_pointer self, const condition_changed& x) {
  const auto found = self->state.links.find(peis::link_id{x.link});
  if (found != self->state.links.end())
    found->second.line.set_condition(x.condition);
}

void on_guard(peer_pointer self, const guard_kernel& x) {
  auto& state = self->state;
  known(self, x.init);
  state.init = x.init;
  const auto& network = state.arguments.config.network;
  const auto port = state.real == nullptr ? std::nullopt : state.real->links().port();
  self->send(state.init, kernel_guarded{network.host_name, network.network, port.value_or(0)});
}

/// Opens the real links, if any. Without them there is no point in a run that only begins; a peer
/// that was started again goes on in the simulated network.
void open_real_links(peer_pointer self) {
  auto& state = self->state;
  if (!state.arguments.real)
    return;
  state.arguments.real->who = self->path();
  state.arguments.real->ecology = state.arguments.ecology;
  auto opened = real_links::open(*state.arguments.real, handle_of<peis_peer_actor>(self));
  if (const auto* why = std::get_if<std::string>(&opened)) {
    self->send(state.arguments.ecology,
               request_unmet{self->path(), *why, state.arguments.is_first});
    return;
  }
  state.real = std::get<std::unique_ptr<real_links>>(std::move(opened));
  auto& network = state.arguments.config.network;
  for (auto& address : state.real->addresses())
    network.addresses.push_back(std::move(address));
  network.link_window = state.real->over_bluetooth() == nullptr ? peer::tcp_links::window
                                                                : peer::bluetooth_links::window;
  network.outside_from = peis::link_id{first_real_link};
}

/// `process` of the peers of a run in virtual time, see process_facts.
constexpr std::uint32_t virtual_process = 1;

void start(peer_pointer self) {
  auto& state = self->state;
  const auto& arguments = state.arguments;
  state.rng = random_stream(arguments.seed, self->path() + "/network");
  open_real_links(self);
  auto rng_path = self->path();
  if (arguments.incarnation > 0)
    rng_path += '#' + std::to_string(arguments.incarnation);
  // Another process of the same file must not draw the same magic number (RTE-08).
  if (const auto process = arguments.config.network.process; process != virtual_process)
    rng_path += '@' + std::to_string(process);
  state.kernel = peis::kernel(arguments.config, random_stream(arguments.seed, rng_path), now(self));
  if (arguments.lan)
    self->send(arguments.lan, join_lan{arguments.station,
                                       arguments.config.network.id,
                                       arguments.discovery,
                                       {handle_of<lan_user_actor>(self)}});
  if (arguments.bluetooth) {
    auto joining = arguments.adapters;
    joining.user = {handle_of<bluetooth_user_actor>(self)};
    self->send(arguments.bluetooth, std::move(joining));
  }
  state.wake.follow(self, state.kernel.deadline());
}

} // namespace

peis_peer_actor::behavior_type peis_peer(peer_pointer self, peis_peer_arguments arguments) {
  self->set_down_handler([self](const caf::down_msg& x) { forget(self, x.source); });
  self->state.arguments = std::move(arguments);
  start(self);
  return {
      served<link_octets>(self),
      served<timer_expired>(self),
      served<link_sent>(self),
      served<link_closed>(self),
      served<link_opened>(self),
      served<bluetooth_opened>(self),
      served<bluetooth_seen>(self),
      served<hello_arrived>(self),
      served<real_hello>(self),
      served<hello_answer>(self),
      [self](const condition_changed& x) { on_condition(self, x); },
      served<attempt_failed>(self),
      served<announcement>(self),
      served<addresses_changed>(self),
      served<set_tuple>(self),
      served<delete_tuple>(self),
      served<set_remote_tuple>(self),
      served<watch_tuples>(self),
      served<declare_meta_tuple>(self),
      served<set_meta_tuple>(self),
      served<watch_indirectly>(self),
      served<watch_subscribers>(self),
      served<watch_clock>(self),
      served<broadcast_peis_message>(self),
      served<hook_port>(self),
      served<send_peis_message>(self),
      [self](const pause_peer& x) { on_pause(self, x); },
      [self](resume_peer) { on_resume(self); },
      served<step_clock>(self),
      [self](leave_network) {
        if (!ask_init(self))
          leave_and_close(self);
      },
      served<quit_peer>(self),
      [self](const guard_kernel& x) { on_guard(self, x); },
      [self](status_request) { send_status(self); },
  };
}

} // namespace rubicon
