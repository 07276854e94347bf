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
#include "peis/media/simulated_bluetooth.hpp"
#include "peis/wire/announcement.hpp"

namespace rubicon {

namespace {

/// A value as components see it: text without its trailing NUL. It is not copied.
payload shown(const peis::tuple& x) {
  return x.form == peis::encoding::text ? x.value.part(0, x.text().size()) : x.value;
}

peis::tuple_content content_of(const payload& value, bool text) {
  return text ? peis::text_content(to_string(value.view())) : peis::binary_content(value);
}

void perform(peer_pointer self, peis::outputs todo);
void tell(peer_pointer self, peis::kernel_clients::outputs todo);

/// Says goodbye and closes all links.
void leave(peer_pointer self) {
  auto& state = self->state;
  if (std::exchange(state.left, true))
    return;
  perform(self, state.kernel.leave(now(self)));
  for (const auto& [id, link] : state.links)
    tell_closed(self, id, link);
  state.links.clear();
  state.tcp_links.clear();
  if (state.real != nullptr)
    state.real->close_all();
}

/// Ends the process of this peer.
void quit(peer_pointer self) {
  leave(self);
  self->quit(caf::exit_reason::user_shutdown);
}

/// Asks the init of its host, whose components end before this does.
/// @returns whether there is one
bool ask_init(peer_pointer self) {
  if (!self->state.init || self->state.left)
    return false;
  self->send(self->state.init, quit_wanted{});
  return true;
}

/// Whether links are closed so while all is well.
bool is_everyday(peis::close_cause x) {
  using peis::close_cause;
  return x == close_cause::double_link || x == close_cause::unneeded ||
         x == close_cause::host_left || x == close_cause::leaf;
}

/// Of what anybody can bring about the log tells a few, the report all.
bool may_tell(peer_pointer self, line_allowance& of, std::string_view events) {
  const auto left_out = of.ask(now(self));
  if (left_out && *left_out > 0)
    log(self, spdlog::level::warn, "event={} left_out={}", events, *left_out);
  return left_out.has_value();
}

void log_closing(peer_pointer self, const peis::close_link& x) {
  if (is_everyday(x.why)) {
    log(self, spdlog::level::info, "event=link_closed link={} cause={}", x.link.value,
        peis::to_string(x.why));
    return;
  }
  if (!may_tell(self, self->state.closings, "links_closed"))
    return;
  log(self, spdlog::level::warn, "event=link_closed link={} cause={}", x.link.value,
      peis::to_string(x.why));
}

/// Tells components what is for them.
struct teller {
  peer_pointer self;

  void operator()(const peis::tell_tuple& x) const {
    const acting_on its(x.from);
    const auto& content = *x.content;
    send<peis_client_actor>(x.client, tuple_event{x.watch, content.owner, content.name.text(),
                                                  shown(content), x.deleted});
  }
  void operator()(peis::tell_message& x) const {
    const acting_on its(x.from);
    send<peis_client_actor>(x.client, peis_message{x.source, x.port, std::move(x.octets)});
  }
  void operator()(const peis::tell_outcome& x) const {
    const acting_on its(x.from);
    send<peis_client_actor>(
        x.client, peis_outcome{x.token, x.success,
                               x.success ? std::string() : std::string(to_string(x.why))});
  }
  void operator()(peis::tell_subscribers& x) const {
    send<subscribers_watcher_actor>(x.client, subscribers_changed{std::move(x.keys)});
  }
  void operator()(const peis::tell_clock& x) const {
    send<clock_watcher_actor>(x.client, clock_changed{x.offset});
  }
  void operator()(const peis::withdraw& x) const {
    perform(self, self->state.kernel.unsubscribe(x.subscription, now(self)));
  }

  template <class Handle, class Message>
  void send(peis::client_id to, Message x) const {
    self->send(Handle(self->state.components.at(to)), std::move(x));
  }
};

void tell(peer_pointer self, peis::kernel_clients::outputs todo) {
  for (auto& output : todo)
    std::visit(teller{self}, output);
}

struct peis_peer_performer {
  peer_pointer self;

  void operator()(peis::to_link& x) const {
    if (x.link.value < first_real_link)
      transmit(self, x.link, std::move(x.octets));
    else if (self->state.real != nullptr)
      self->state.real->carry_out(std::move(x));
  }

  void operator()(const peis::close_link& x) const {
    auto& state = self->state;
    log_closing(self, x);
    ++state.links_closed[std::string(peis::to_string(x.why))];
    if (state.tcp_links.erase(x.link) > 0 && state.real != nullptr) {
      state.real->carry_out(x);
      state.real->hold(x.link, false);
      self->send(state.arguments.ecology, outside_link_changed{});
    }
    const auto found = state.links.find(x.link);
    if (found == state.links.end())
      return;
    tell_closed(self, x.link, found->second);
    state.links.erase(found);
    if (x.link.value >= peis::first_bluetooth_link)
      self->send(state.arguments.bluetooth, lan_link_ended{x.link.value});
    else if (state.arguments.lan)
      self->send(state.arguments.lan, lan_link_ended{x.link.value});
  }

  /// Simulated links have no other end that could wait.
  void operator()(const peis::read_link& x) const {
    if (x.link.value < first_real_link || self->state.real == nullptr)
      return;
    self->state.real->hold(x.link, !x.wanted);
  }

  /// Simulated links take packages as a whole.
  void operator()(const peis::pace_link& x) const {
    if (x.link.value >= first_real_link && self->state.real != nullptr)
      self->state.real->carry_out(x);
  }

  void operator()(const peis::connect_to& x) const { ask_for_link(self, x); }

  void operator()(const peis::announce& x) const {
    const auto& arguments = self->state.arguments;
    if (arguments.discovery && arguments.lan)
      self->send(arguments.lan, lan_announce{arguments.station, x.octets});
    if (self->state.real != nullptr) {
      auto octets = to_bytes(x.octets.view());
      peis::hide_inproc_of_announcement(octets);
      self->state.real->carry_out(peis::announce{std::move(octets)});
    }
  }

  void operator()(peis::scan_adapter& x) const {
    const auto& arguments = self->state.arguments;
    if (arguments.bluetooth)
      self->send(arguments.bluetooth, scan_bluetooth{arguments.station, std::move(x.adapter)});
    else if (self->state.real != nullptr)
      self->state.real->carry_out(x);
  }

  void operator()(peis::say_hello& x) const {
    const auto& arguments = self->state.arguments;
    if (arguments.bluetooth)
      self->send(arguments.bluetooth,
                 send_hello{arguments.station, {std::move(x.adapter), x.to, std::move(x.octets)}});
    else if (self->state.real != nullptr)
      self->state.real->carry_out(std::move(x));
  }

  void operator()(const peis::traced&) const {} // nobody here asks

  void operator()(const peis::tuple_changed& x) const { tell(self, self->state.clients.on(x)); }
  void operator()(const peis::tuple_deleted& x) const { tell(self, self->state.clients.on(x)); }
  void operator()(peis::message& x) const { tell(self, self->state.clients.on(std::move(x))); }
  void operator()(const peis::outcome& x) const { tell(self, self->state.clients.on(x)); }

  void operator()(const peis::host_appeared& x) const {
    log(self, spdlog::level::info, "event=host_appeared host={}", x.host.value);
  }
  void operator()(const peis::host_vanished& x) const {
    log(self, spdlog::level::info, "event=host_vanished host={}", x.host.value);
  }
  void operator()(const peis::quit_requested& x) const {
    log(self, spdlog::level::info, "event=quit_requested by={}", x.by.value);
    if (!ask_init(self))
      quit(self);
  }
  void operator()(peis::debug_requested& x) const {
    if (may_tell(self, self->state.debugs, "debug_requests"))
      self->send(self->state.arguments.ecology, debug_wanted{self->path(), std::move(x.text)});
  }
  void operator()(const peis::intercepted& x) const {
    log(self, spdlog::level::info, "event=intercepted port={} source={} destination={}", x.port,
        x.source.value, x.destination.value);
  }
  void operator()(const peis::namesake_found& x) const {
    log(self, spdlog::level::warn, "event=namesake host={} is={}", x.host.value, x.full_name);
    self->send(self->state.arguments.ecology,
               notable_event{self->path(), "the computer of " + x.full_name +
                                               " has the same name as this one: give one of them "
                                               "another name"});
  }
  void operator()(const peis::id_taken& x) const {
    const auto& ecology = self->state.arguments.ecology;
    if (x.stays_away > duration(0)) {
      log(self, spdlog::level::err, "event=id_left_to by={} away_s={}", x.by,
          seconds(x.stays_away));
      self->send(ecology, notable_event{self->path(), "leaves its id to " + x.by});
    } else if (may_tell(self, self->state.claims, "ids_taken")) {
      log(self, spdlog::level::err, "event=id_taken by={}", x.by);
      self->send(ecology, notable_event{self->path(), "its id is used by " + x.by});
    }
  }
};

void perform(peer_pointer self, peis::outputs todo) {
  auto& state = self->state;
  for (auto& output : todo)
    std::visit(peis_peer_performer{self}, output);
  tell(self, state.clients.review(state.kernel, now(self)));
  state.wake.follow(self, earliest(state.kernel.deadline(), state.clients.deadline()));
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
  tell(self, state.clients.forget(id));
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
  perform(self, state.kernel.on_link_open(id, role, now(self), attempt));
}

/// Serves what has come while the kernel does not stand still.
struct server {
  peer_pointer self;
  peis_peer_state& state = self->state;
  instant at = now(self);

  void operator()(const link_octets& x) const {
    const peis::link_id link{x.link};
    perform(self, state.kernel.on_link_octets(link, x.octets.view(), at));
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
    perform(self, state.kernel.on_link_closed(id, at));
  }
  void operator()(const link_opened& x) const {
    on_opened(self, x, state.arguments.network.bandwidth_bps);
  }
  void operator()(const bluetooth_opened& x) const { on_opened(self, x.link, x.rate_bps); }
  void operator()(const bluetooth_seen& x) const {
    perform(self, state.kernel.on_bluetooth_scan(x.adapter, x.devices, at));
  }
  /// Tells who asks that we are a peer, and learns who that is.
  void operator()(const hello_arrived& x) const {
    if (state.left)
      return;
    perform(self, state.kernel.on_hello(x.question.octets.view(), at));
    self->delayed_send(x.sender, state.arguments.network.delay,
                       hello_answer{x.question.adapter, x.question.device, state.kernel.hello()});
  }
  void operator()(const real_hello& x) const {
    if (state.left || state.real == nullptr)
      return;
    perform(self, state.kernel.on_hello(x.octets.view(), at));
    state.real->answer_hello(x.connection, state.kernel.hello());
  }
  void operator()(const hello_answer& x) const {
    perform(self, state.kernel.on_hello_answer(x.adapter, x.device, x.octets.view(), at));
  }
  void operator()(const attempt_failed& x) const {
    perform(self, state.kernel.on_attempt_failed(peis::attempt_id{x.attempt}, at));
  }
  void operator()(const announcement& x) const {
    const bool has_address = x.from != ipv4_address{};
    perform(self, state.kernel.on_announcement(x.octets.view(), at,
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
    perform(self, state.kernel.set_addresses(all, at));
  }
  void operator()(const link_sent& x) const {
    perform(self, state.kernel.on_link_sent(peis::link_id{x.link}, x.octets, at));
  }
  void operator()(const set_tuple& x) const {
    perform(self, state.kernel.set_tuple(x.key, content_of(x.value, x.text), at));
  }
  void operator()(const delete_tuple& x) const {
    perform(self, state.kernel.delete_tuple(x.key, at));
  }
  void operator()(const set_remote_tuple& x) const {
    const auto request = state.clients.request(known(self, x.client), x.token);
    perform(self, state.kernel.set_remote_tuple(x.owner, x.key, content_of(x.value, x.text),
                                                request, at));
  }
  void operator()(const watch_tuples& x) const {
    const auto watch = state.clients.watch(known(self, x.client), x.watch);
    perform(self, state.kernel.subscribe(x.owner, x.key, watch, at));
  }
  void operator()(const watch_indirectly& x) const {
    const auto watch = state.clients.watch(known(self, x.client), x.watch);
    perform(self, state.kernel.subscribe_indirectly(x.owner, x.key, watch, at));
  }
  void operator()(const declare_meta_tuple& x) const {
    auto& kernel = state.kernel;
    if (!kernel.is_meta_tuple(kernel.id(), x.key))
      perform(self, kernel.set_tuple(x.key, reference_content(x.reference), at));
  }
  void operator()(const set_meta_tuple& x) const {
    const auto request = state.clients.request(known(self, x.client), x.token);
    perform(self, state.kernel.set_remote_tuple(x.owner, x.key, reference_content(x.reference),
                                                request, at));
  }
  void operator()(const watch_subscribers& x) const {
    const auto who = known(self, x.watcher);
    tell(self, state.clients.watch_subscribers(who, x.first_part, state.kernel, at));
  }
  void operator()(const watch_clock& x) const {
    tell(self, state.clients.watch_clock(known(self, x.watcher), state.kernel));
  }
  void operator()(const hook_port& x) const {
    const auto who = known(self, x.client);
    if (!state.kernel.hook_port(x.port) || !state.clients.hook(who, x.port))
      log(self, spdlog::level::err, "event=hook_refused port={}", x.port);
  }
  void operator()(const send_peis_message& x) const {
    const auto request = state.clients.request(known(self, x.client), x.token);
    perform(self, state.kernel.send_message(x.destination, x.port, x.octets, x.reliable,
                                            peis::priority::normal, request, at));
  }
  void operator()(const broadcast_peis_message& x) const {
    perform(self, state.kernel.broadcast(x.port, x.octets, peis::no_request, at));
  }
  void operator()(const step_clock& x) const { perform(self, state.kernel.step_clock(x.by, at)); }
  void operator()(quit_peer) const { quit(self); }
  void operator()(const timer_expired& x) const {
    if (state.wake.accepts(x))
      perform(self, state.kernel.on_time(at));
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
          leave(self);
      },
      served<quit_peer>(self),
      [self](const guard_kernel& x) { on_guard(self, x); },
      [self](status_request) { send_status(self); },
  };
}

} // namespace rubicon
