#include "actors/peis_peer.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "actors/log.hpp"
#include "actors/peis_bluetooth.hpp"
#include "scheduler/supervision.hpp"

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
    state.real->links().close_all();
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

struct performer {
  peer_pointer self;

  void operator()(peis::to_link& x) const {
    if (x.link.value < first_real_link)
      transmit(self, x.link, std::move(x.octets));
    else if (self->state.real != nullptr)
      self->state.real->links().carry_out(std::move(x));
  }

  void operator()(const peis::close_link& x) const {
    auto& state = self->state;
    log_closing(self, x);
    ++state.links_closed[std::string(peis::to_string(x.why))];
    if (state.tcp_links.erase(x.link) > 0 && state.real != nullptr) {
      state.real->links().carry_out(x);
      state.real->hold(x.link, false);
      self->send(state.arguments.ecology, outside_link_changed{});
    }
    const auto found = state.links.find(x.link);
    if (found == state.links.end())
      return;
    tell_closed(self, x.link, found->second);
    state.links.erase(found);
    if (x.link.value >= first_bluetooth_link)
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

  void operator()(const peis::connect_to& x) const { ask_for_link(self, x); }

  void operator()(const peis::announce& x) const {
    const auto& arguments = self->state.arguments;
    if (arguments.discovery && arguments.lan)
      self->send(arguments.lan, lan_announce{arguments.station, x.octets});
    if (self->state.real != nullptr) {
      auto octets = to_bytes(x.octets.view());
      peis::hide_inproc_of_announcement(octets);
      self->state.real->links().carry_out(peis::announce{std::move(octets)});
    }
  }

  void operator()(peis::scan_adapter& x) const {
    const auto& arguments = self->state.arguments;
    if (arguments.bluetooth)
      self->send(arguments.bluetooth, scan_bluetooth{arguments.station, std::move(x.adapter)});
  }

  void operator()(peis::say_hello& x) const {
    const auto& arguments = self->state.arguments;
    if (arguments.bluetooth)
      self->send(arguments.bluetooth,
                 send_hello{arguments.station, {std::move(x.adapter), x.to, std::move(x.octets)}});
  }

  void operator()(const peis::traced&) const {} // nobody here asks

  void operator()(const peis::tuple_changed& x) const {
    const acting_on its(x.content->from);
    tell(x.subscription, *x.content, false);
  }
  void operator()(const peis::tuple_deleted& x) const {
    const acting_on its(x.from);
    tell(x.subscription, *x.content, true);
  }

  void operator()(peis::message& x) const {
    const acting_on its(x.from);
    const auto found = self->state.ports.find(x.port);
    if (found != self->state.ports.end())
      self->send(found->second, peis_message{x.source, x.port, std::move(x.octets)});
  }

  void operator()(const peis::outcome& x) const {
    const auto found = self->state.requests.find(x.request);
    if (found == self->state.requests.end())
      return;
    const acting_on its(found->second.from);
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
    if (!ask_init(self))
      quit(self);
  }
  void operator()(const peis::intercepted& x) const {
    log(self, spdlog::level::info, "event=intercepted port={} source={} destination={}", x.port,
        x.source.value, x.destination.value);
  }
  void operator()(const peis::id_taken& x) const {
    const auto& ecology = self->state.arguments.ecology;
    if (x.stays_away > duration(0)) {
      log(self, spdlog::level::err, "event=id_left_to by={} away_s={}", x.by,
          seconds(x.stays_away));
      self->send(ecology, story{self->path(), "leaves its id to " + x.by});
    } else if (may_tell(self, self->state.claims, "ids_taken")) {
      log(self, spdlog::level::err, "event=id_taken by={}", x.by);
      self->send(ecology, story{self->path(), "its id is used by " + x.by});
    }
  }

  void tell(peis::subscription_id subscription, const peis::tuple& x, bool deleted) const {
    const auto found = self->state.watches.find(subscription);
    if (found != self->state.watches.end())
      self->send(found->second.client,
                 tuple_event{found->second.name, x.owner, x.name.text(), shown(x), deleted});
  }
};

void tell_subscribers(peer_pointer self) {
  auto& state = self->state;
  const auto version = state.kernel.subscribers_version();
  if (!state.subscribers_watcher || state.subscribers_version == version)
    return;
  const bool first = !state.subscribers_version;
  const auto pause = 10us * state.subscribers_told.size(); // others choose how many they are
  if (!first && pause > 1ms && now(self) < state.subscribers_told_at + pause) {
    state.subscribers_due = state.subscribers_told_at + pause;
    return;
  }
  state.subscribers_due.reset();
  state.subscribers_told_at = now(self);
  state.subscribers_version = version;
  const auto keys = state.kernel.subscribed(state.subscribers_first_part);
  if (!first && std::ranges::equal(keys, state.subscribers_told))
    return;
  state.subscribers_told.assign(keys.begin(), keys.end());
  self->send(state.subscribers_watcher, subscribers_changed{state.subscribers_told});
}

void tell_clock(peer_pointer self) {
  auto& state = self->state;
  const auto offset = state.kernel.clock().offset();
  if (std::exchange(state.clock_told, offset) == offset)
    return;
  for (const auto& watcher : state.clock_watchers)
    self->send(watcher, clock_changed{offset});
}

void perform(peer_pointer self, peis::outputs todo) {
  for (auto& output : todo)
    std::visit(performer{self}, output);
  tell_subscribers(self);
  tell_clock(self);
  self->state.wake.follow(self,
                          earliest(self->state.kernel.deadline(), self->state.subscribers_due));
}

template <class Handle>
void know(peer_pointer self, const Handle& client) {
  if (self->state.clients.insert(client.address()).second)
    self->monitor(client);
}

/// A component has ended: nobody is to hear of its watches, requests and ports any more.
void forget(peer_pointer self, const caf::actor_addr& client) {
  auto& state = self->state;
  state.clients.erase(client);
  if (state.subscribers_watcher && state.subscribers_watcher.address() == client)
    state.subscribers_watcher = nullptr;
  std::erase_if(state.clock_watchers, [&](const auto& x) { return x.address() == client; });
  if (state.init && state.init.address() == client)
    state.init = nullptr;
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

void on_watch_indirectly(peer_pointer self, const watch_indirectly& x) {
  know(self, x.client.actor);
  const peis::subscription_id id{self->state.next_watch++};
  self->state.watches[id] = {x.client.actor, x.watch};
  perform(self, self->state.kernel.subscribe_indirectly(x.owner, x.key, id, now(self)));
}

peis::tuple_content reference_content(const std::string& reference) {
  const auto target = peis::parse_meta(reference);
  assert(target); // our own programs write references as format_meta() does
  return peis::meta_content(*target);
}

void on_declare(peer_pointer self, const declare_meta_tuple& x) {
  auto& kernel = self->state.kernel;
  if (!kernel.is_meta_tuple(kernel.id(), x.key))
    perform(self, kernel.set_tuple(x.key, reference_content(x.reference), now(self)));
}

void on_set_meta(peer_pointer self, const set_meta_tuple& x) {
  const auto request = remember(self, x.client, x.token);
  perform(self, self->state.kernel.set_remote_tuple(x.owner, x.key, reference_content(x.reference),
                                                    request, now(self)));
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

void on_watch_subscribers(peer_pointer self, const watch_subscribers& x) {
  auto& state = self->state;
  know(self, x.watcher.actor);
  state.subscribers_watcher = x.watcher.actor;
  state.subscribers_first_part = x.first_part;
  state.subscribers_version.reset();
  tell_subscribers(self);
}

void on_watch_clock(peer_pointer self, const watch_clock& x) {
  auto& state = self->state;
  know(self, x.watcher.actor);
  state.clock_watchers.push_back(x.watcher.actor);
  self->send(x.watcher.actor, clock_changed{state.kernel.clock().offset()});
}

void on_guard(peer_pointer self, const guard_kernel& x) {
  auto& state = self->state;
  know(self, caf::actor_cast<peis_client_actor>(x.init.actor));
  state.init = x.init.actor;
  const auto& network = state.arguments.config.network;
  const auto port = state.real == nullptr ? std::nullopt : state.real->links().port();
  self->send(state.init, kernel_guarded{network.host_name, network.network, port.value_or(0)});
}

/// What limits have refused or put off (docs/security.md).
void add_limits(runtime::cause_counts& to, const peis::kernel_counters& counted) {
  const auto& x = counted.network;
  const auto& tuples = counted.tuples;
  const std::pair<const char*, std::uint64_t> all[] = {
      {"over_budget", x.rests},
      {"turns", x.held},
      {"fragments_refused", x.fragments_refused},
      {"greetings_evicted", x.greetings_evicted},
      {"hosts_refused", x.hosts_refused},
      {"newcomers_referred", x.newcomers_referred},
      {"questions_refused", x.questions_refused},
      {"routes_refused", x.routes_refused},
      {"rivals_refused", x.rivals_refused},
      {"claims_refused", x.claims_refused},
      {"tables_put_off", x.tables_put_off},
      {"tuples_full", tuples.overflow},
      {"tuples_malformed", tuples.malformed},
      {"subscriptions_full", tuples.subscribers_refused},
      {"strangers", tuples.strangers_refused},
      {"appends_refused", tuples.appends_refused},
      {"orphans", tuples.orphans_removed},
      {"stale_removed", tuples.stale_removed},
      {"resyncs", tuples.resyncs},
      {"pushes_given_up", tuples.pushes_given_up},
      {"absent_forgotten", tuples.absent_forgotten}};
  for (const auto& [name, count] : all) {
    if (count > 0)
      to[name] = count;
  }
}

void report(peer_pointer self) {
  const auto& state = self->state;
  const auto all_counted = state.kernel.counters();
  const auto& counted = all_counted.network;
  peer_status status;
  auto& peer = status.peer;
  peer.id = state.kernel.id();
  peer.name = state.arguments.name;
  peer.incarnations = state.arguments.incarnation + 1;
  peer.links = state.links.size() + state.tcp_links.size();
  peer.links_opened = counted.links_opened;
  peer.links_closed = state.links_closed;
  peer.attempts = counted.attempts;
  peer.attempts_failed = counted.attempts_failed;
  for (const auto* host : state.kernel.hosts()) {
    if (state.kernel.knows_present(host->id) || !state.kernel.reachable(host->id))
      status.hosts.push_back(host->id);
    if (host->id == peer.id)
      peer.cluster = host->cluster;
  }
  for (const auto& link : state.kernel.links()) {
    if (link.neighbour)
      status.neighbours.push_back(*link.neighbour);
  }
  const auto time = state.kernel.network_time(now(self));
  status.clock_offset = std::chrono::seconds(time.seconds) +
                        std::chrono::microseconds(time.microseconds) - now(self).time_since_epoch();
  peer.hosts_known = status.hosts.size();
  peer.tuples = state.kernel.own_tuples().size();
  peer.peis.packages = counted.packages_sent;
  peer.peis.tuples = peer.tuples;
  peer.peis.lost = {{"queue_full", counted.queue_full},
                    {"early_drop", counted.early_drop},
                    {"no_route", counted.no_route},
                    {"hops", counted.hops},
                    {"queued_lost", counted.queued_lost},
                    {"illegal", counted.illegal},
                    {"malformed", counted.malformed},
                    {"incomplete", counted.messages_incomplete},
                    {"network", state.packages_lost},
                    {"paused", state.held_lost},
                    {"own_id", counted.own}};
  add_limits(peer.limits, all_counted);
  if (state.real != nullptr && state.real->links().counters().refused > 0)
    peer.limits["connections_refused"] = state.real->links().counters().refused;
  self->send(state.arguments.ecology, std::move(status));
}

/// @param rate_bps of a simulated link
void on_opened(peer_pointer self, const link_opened& x, std::uint64_t rate_bps) {
  auto& state = self->state;
  const peis::link_id id{x.link};
  if (state.left)
    return;
  if (x.link >= first_real_link) {
    state.tcp_links.insert(id);
    self->send(state.arguments.ecology, outside_link_changed{});
  } else
    state.links[id] = {x.other.actor, x.condition, x.initiator, {}, rate_bps};
  const auto role = x.initiator ? peis::link_role::initiator : peis::link_role::acceptor;
  const auto attempt = x.attempt == 0 ? std::nullopt : std::optional(peis::attempt_id{x.attempt});
  perform(self, state.kernel.on_link_open(id, role, now(self), attempt));
}

void on_closed(peer_pointer self, const link_closed& x) {
  auto& state = self->state;
  const peis::link_id id{x.link};
  const bool was_outside = state.tcp_links.erase(id) > 0;
  if (was_outside)
    self->send(state.arguments.ecology, outside_link_changed{});
  if (was_outside || state.links.erase(id) > 0)
    ++state.links_closed["far_end"];
  perform(self, state.kernel.on_link_closed(id, now(self)));
}

/// Tells who asks that we are a peer, and learns who that is.
void on_hello(peer_pointer self, const hello_arrived& x) {
  auto& state = self->state;
  if (state.left)
    return;
  perform(self, state.kernel.on_hello(x.question.octets.view(), now(self)));
  self->delayed_send(x.sender.actor, state.arguments.network.delay,
                     hello_answer{x.question.adapter, x.question.device, state.kernel.hello()});
}

void on_pause(peer_pointer self, const pause_peer& x) {
  if (std::exchange(self->state.paused, true))
    return;
  self->send(self->state.arguments.ecology, story{self->path(), "paused"});
  self->delayed_send(self, x.length, resume_peer{});
}

void on_resume(peer_pointer self) {
  self->state.paused = false;
  self->send(self->state.arguments.ecology, story{self->path(), "goes on"});
  for (const auto& serve : std::exchange(self->state.held, {}))
    serve();
}

/// A handler that waits while the kernel stands still.
template <class Message, class Handler>
auto served(peer_pointer self, Handler handle) {
  return [self, handle](const Message& x) {
    auto& state = self->state;
    if (!state.paused)
      handle(x);
    else if (state.held.size() < held_max)
      state.held.emplace_back([handle, x] { handle(x); });
    else
      ++state.held_lost;
  };
}

/// Opens the real links, if any. Without them there is no point in a run that only begins; a peer
/// that was started again goes on in the simulated network.
void open_real_links(peer_pointer self) {
  auto& state = self->state;
  if (!state.arguments.real)
    return;
  state.arguments.real->who = self->path();
  state.arguments.real->ecology = state.arguments.ecology;
  auto opened = real_links::open(*state.arguments.real, caf::actor_cast<peis_peer_actor>(self));
  if (const auto* why = std::get_if<std::string>(&opened)) {
    self->send(state.arguments.ecology, request_unmet{self->path(), "cannot listen: " + *why,
                                                      state.arguments.incarnation == 0});
    return;
  }
  state.real = std::get<std::unique_ptr<real_links>>(std::move(opened));
  auto& links = state.real->links();
  auto& network = state.arguments.config.network;
  for (auto& address : links.addresses())
    network.addresses.push_back(std::move(address));
  network.link_window = peer::tcp_links::window;
  network.outside_from = peis::link_id{first_real_link};
}

void start(peer_pointer self) {
  auto& state = self->state;
  const auto& arguments = state.arguments;
  state.rng = random_stream(arguments.seed, self->path() + "/network");
  open_real_links(self);
  const auto rng_path =
      self->path() +
      (arguments.incarnation == 0 ? std::string() : '#' + std::to_string(arguments.incarnation));
  state.kernel = peis::kernel(arguments.config, random_stream(arguments.seed, rng_path), now(self));
  if (arguments.lan)
    self->send(arguments.lan, join_lan{arguments.station,
                                       arguments.config.network.id,
                                       arguments.discovery,
                                       {caf::actor_cast<lan_user_actor>(self)}});
  if (arguments.bluetooth) {
    auto joining = arguments.adapters;
    joining.user = {caf::actor_cast<bluetooth_user_actor>(self)};
    self->send(arguments.bluetooth, std::move(joining));
  }
  state.wake.follow(self, state.kernel.deadline());
}

} // namespace

peis_peer_actor::behavior_type peis_peer(peer_pointer self, peis_peer_arguments arguments) {
  scheduler::tell_monitors_of_exceptions(self);
  self->set_down_handler([self](const caf::down_msg& x) { forget(self, x.source); });
  self->state.arguments = std::move(arguments);
  start(self);
  return {
      served<link_octets>(self,
                          [self](const link_octets& x) {
                            perform(self, self->state.kernel.on_link_octets(
                                              peis::link_id{x.link}, x.octets.view(), now(self)));
                            if (x.link >= first_real_link && self->state.real != nullptr)
                              self->state.real->on_taken(peis::link_id{x.link});
                          }),
      served<link_closed>(self, [self](const link_closed& x) { on_closed(self, x); }),
      served<link_opened>(self,
                          [self](const link_opened& x) {
                            on_opened(self, x, self->state.arguments.network.bandwidth_bps);
                          }),
      served<bluetooth_opened>(
          self, [self](const bluetooth_opened& x) { on_opened(self, x.link, x.rate_bps); }),
      served<bluetooth_seen>(self,
                             [self](const bluetooth_seen& x) {
                               perform(self, self->state.kernel.on_bluetooth_scan(
                                                 x.adapter, x.devices, now(self)));
                             }),
      served<hello_arrived>(self, [self](const hello_arrived& x) { on_hello(self, x); }),
      served<hello_answer>(self,
                           [self](const hello_answer& x) {
                             perform(self, self->state.kernel.on_hello_answer(
                                               x.adapter, x.device, x.octets.view(), now(self)));
                           }),
      [self](const condition_changed& x) {
        const auto found = self->state.links.find(peis::link_id{x.link});
        if (found != self->state.links.end())
          found->second.condition = x.condition;
      },
      served<attempt_failed>(self,
                             [self](const attempt_failed& x) {
                               perform(self, self->state.kernel.on_attempt_failed(
                                                 peis::attempt_id{x.attempt}, now(self)));
                             }),
      served<announcement>(self,
                           [self](const announcement& x) {
                             perform(self, self->state.kernel.on_announcement(x.octets.view(),
                                                                              now(self)));
                           }),
      served<link_sent>(self,
                        [self](const link_sent& x) {
                          perform(self, self->state.kernel.on_link_sent(peis::link_id{x.link},
                                                                        x.octets, now(self)));
                        }),
      served<set_tuple>(self,
                        [self](const set_tuple& x) {
                          perform(self, self->state.kernel.set_tuple(
                                            x.key, content_of(x.value, x.text), now(self)));
                        }),
      served<delete_tuple>(self,
                           [self](const delete_tuple& x) {
                             perform(self, self->state.kernel.delete_tuple(x.key, now(self)));
                           }),
      served<set_remote_tuple>(self,
                               [self](const set_remote_tuple& x) {
                                 const auto request = remember(self, x.client, x.token);
                                 perform(self, self->state.kernel.set_remote_tuple(
                                                   x.owner, x.key, content_of(x.value, x.text),
                                                   request, now(self)));
                               }),
      served<watch_tuples>(self, [self](const watch_tuples& x) { on_watch(self, x); }),
      served<declare_meta_tuple>(self,
                                 [self](const declare_meta_tuple& x) { on_declare(self, x); }),
      served<set_meta_tuple>(self, [self](const set_meta_tuple& x) { on_set_meta(self, x); }),
      served<watch_indirectly>(self,
                               [self](const watch_indirectly& x) { on_watch_indirectly(self, x); }),
      served<watch_subscribers>(
          self, [self](const watch_subscribers& x) { on_watch_subscribers(self, x); }),
      served<watch_clock>(self, [self](const watch_clock& x) { on_watch_clock(self, x); }),
      served<broadcast_peis_message>(self,
                                     [self](const broadcast_peis_message& x) {
                                       perform(self, self->state.kernel.broadcast(x.port, x.octets,
                                                                                  peis::no_request,
                                                                                  now(self)));
                                     }),
      served<hook_port>(self, [self](const hook_port& x) { on_hook(self, x); }),
      served<send_peis_message>(self,
                                [self](const send_peis_message& x) {
                                  const auto request = remember(self, x.client, x.token);
                                  perform(self, self->state.kernel.send_message(
                                                    x.destination, x.port, x.octets, x.reliable,
                                                    peis::priority::normal, request, now(self)));
                                }),
      [self](const pause_peer& x) { on_pause(self, x); },
      [self](resume_peer) { on_resume(self); },
      served<step_clock>(self,
                         [self](const step_clock& x) {
                           perform(self, self->state.kernel.step_clock(x.by, now(self)));
                         }),
      [self](leave_network) {
        if (!ask_init(self))
          leave(self);
      },
      served<quit_peer>(self, [self](quit_peer) { quit(self); }),
      [self](const guard_kernel& x) { on_guard(self, x); },
      served<timer_expired>(self,
                            [self](const timer_expired& x) {
                              if (self->state.wake.accepts(x))
                                perform(self, self->state.kernel.on_time(now(self)));
                            }),
      [self](status_request) { report(self); },
  };
}

} // namespace rubicon
