#include "peis/p2p/p2p.hpp"

#include <utility>
#include <variant>

#include "core/account/message_ledger.hpp"

#include "peis/p2p/package_handler.hpp"
#include "peis/wire/announcement.hpp"

namespace rubicon::peis {

namespace {

/// A HELLO is to carry who we are.
event event_of(bluetooth::output& x, const bytes& hello) {
  if (auto* scan = std::get_if<scan_adapter>(&x))
    return std::move(*scan);
  if (auto* ask = std::get_if<ask_device>(&x))
    return say_hello{std::move(ask->adapter), ask->address, hello};
  return std::get<device_noted>(std::move(x));
}

} // namespace

/// Later ones refer to earlier ones.
struct p2p::parts {
  parts(p2p_config config, random_stream rng, instant now);

  [[nodiscard]] occasion at(instant now) { return {now, out}; }
  [[nodiscard]] bool is_away() const { return rivalry.is_away() && !own.left; }
  void apply(bluetooth::outputs todo);
  void serve(connection& from, instant now);
  void tend_links(const occasion& x);
  void tend_hosts(const occasion& x);
  void tend_connections(const occasion& x);

  own_peer own;
  events out;
  id_rivalry rivalry;
  bluetooth adapters;
  traffic_meter traffic;
  seen_ids seen;
  transit_hooks hooks;
  link_table links;
  link_input input;
  package_sender sender;
  overlay routes;
  routing_exchange exchange;
  host_table hosts;
  link_health health;
  heartbeats beats;
  message_delivery messages;
  link_writer writer;
  route_tracer tracer;
  clock_service clock;
  host_inquiry inquiry;
  announcer announcements;
  contact_history contacts;
  dialler dials;
  host_presence presence;
  link_closer closer;
  host_removal removal;
  link_replacer replacer;
  id_guard guard;
  own_id duplicates;
  matchmaker matches;
  link_greeting greeting;
  incarnations records;
  introductions names;
  routing_updates updates;
  package_handler packages;
};

p2p::parts::parts(p2p_config config, random_stream rng, instant now)
    : own(std::move(config), rng), rivalry(own.self.magic, now),
      adapters(own.config.bluetooth, now), traffic(own.config.tables.routes, now),
      seen(own.config.tables.seen, own.rng), links(own.config), input(own, links, now),
      sender(own, links), routes(own, links), exchange(own, links, routes, sender, now),
      hosts(own, links, routes), health(own, links, hosts), beats(own, links, health, sender),
      messages(own, links, routes, sender, traffic), writer(own, health, messages),
      tracer(own, links, routes, sender), clock(own, links, hosts, sender, now),
      inquiry(own, links, routes, hosts, sender, messages), announcements(own, rivalry, hosts, now),
      contacts(own, links, hosts), dials(own, links, routes, hosts, contacts, adapters, now),
      presence({own, routes, exchange, hosts, inquiry, messages, tracer, contacts, traffic,
                announcements}),
      closer({own, links, input, health, seen, contacts, dials, messages, routes, presence}),
      removal({own, links, routes, exchange, hosts, contacts, presence, closer}),
      replacer(own, links, hosts, health, sender, dials, closer),
      guard(own, links, hosts, sender, writer, closer),
      duplicates({own, rivalry, links, routes, exchange, hosts, dials, presence, closer, removal}),
      matches({own, links, routes, hosts, health, contacts, traffic, dials, closer}, now),
      greeting({own, rivalry, links, routes, exchange, hosts, sender, writer, health, beats, dials,
                presence, closer, matches}),
      records({own, links, routes, exchange, hosts, inquiry, contacts, dials, beats, announcements,
               presence, removal, guard, duplicates, matches}),
      names({own, links, routes, hosts, sender, writer, health, dials, presence, closer, guard,
             duplicates, greeting, records}),
      updates({own, links, routes, exchange, hosts, inquiry, presence, removal, replacer}),
      packages({own, links, routes, seen, sender, traffic, messages, hooks, tracer, clock, beats,
                inquiry, guard, duplicates, records, names, updates}) {}

p2p::p2p() : p2p(p2p_config(), random_stream(), instant()) {}
p2p::p2p(p2p_config config, random_stream rng, instant now)
    : parts_(std::make_unique<parts>(std::move(config), rng, now)) {}
p2p::~p2p() = default;
p2p::p2p(p2p&&) noexcept = default;
p2p& p2p::operator=(p2p&&) noexcept = default;

void p2p::on_link_open(link_id link, link_role role, instant now,
                       std::optional<attempt_id> attempt) {
  if (parts_->greeting.open(link, role, attempt, parts_->at(now)))
    parts_->input.note_time(now);
}

void p2p::on_attempt_failed(attempt_id attempt, instant now) {
  parts_->dials.on_attempt_failed(attempt, now);
}

void p2p::on_announcement(byte_view octets, instant now, std::optional<ipv4_address> from) {
  parts_->records.on_announcement(octets, from, parts_->at(now));
}

void p2p::parts::apply(bluetooth::outputs todo) {
  if (todo.empty())
    return;
  const auto hello = own.hello();
  for (auto& x : todo)
    out.push_back(event_of(x, hello));
}

void p2p::on_bluetooth_scan(std::string_view adapter, std::span<const seen_device> seen,
                            instant now) {
  if (!parts_->own.left)
    parts_->apply(parts_->adapters.on_scan(adapter, seen, now));
}

/// A peer of another network answers as well; its record is of no use to us.
void p2p::on_hello_answer(std::string_view adapter, const bluetooth_address& address,
                          byte_view octets, instant now) {
  if (parts_->own.left)
    return;
  const bool is_peer = static_cast<bool>(decode_announcement(octets));
  parts_->apply(parts_->adapters.on_answer(adapter, address, is_peer, now));
  if (is_peer)
    on_announcement(octets, now);
}

void p2p::on_link_octets(link_id link, byte_view octets, instant now) {
  if (auto* x = parts_->links.find(link))
    parts_->input.on_octets(*x, octets, now);
}

void p2p::on_link_sent(link_id link, std::size_t octets, instant now) {
  if (auto* x = parts_->links.find(link))
    parts_->writer.on_sent(*x, octets, now);
}

void p2p::on_link_closed(link_id link, instant now) {
  if (auto* x = parts_->links.find(link))
    parts_->closer.on_closed(*x, parts_->at(now));
}

void p2p::on_time(instant now) {
  auto& x = *parts_;
  const auto at = x.at(now);
  x.input.note_time(now);
  x.duplicates.on_time(at);
  if (x.is_away())
    return;
  if (!x.own.left)
    x.updates.on_period(at);
  x.messages.on_time(now);
  x.tend_links(at);
  x.updates.apply_waiting(at);
  x.tend_hosts(at);
  x.tend_connections(at);
}

void p2p::parts::tend_links(const occasion& x) {
  for (const auto& [link, why] : health.take_silent(x.now)) {
    ++(why == close_cause::silent ? own.counters.links_broken : own.counters.links_refused);
    closer.close(link, why, x);
  }
}

/// Signs of life, proof of routes, the clock.
void p2p::parts::tend_hosts(const occasion& x) {
  beats.on_time(x.now);
  for (const auto host : tracer.probe_due(x.now))
    updates.disprove(host, x);
  tracer.end_late_traces(x);
  if (own.left)
    return;
  updates.remove_lost(x);
  clock.on_time(x.now);
}

void p2p::parts::tend_connections(const occasion& x) {
  if (own.left)
    return;
  dials.on_time(x.now);
  apply(adapters.on_time(x.now));
  dials.dial_standing(x);
  announcements.on_time(x);
  matches.on_time(x);
  replacer.on_time(x);
}

std::optional<instant> p2p::deadline() const {
  const auto& x = *parts_;
  if (x.is_away())
    return x.rivalry.deadline();
  auto next = earliest(x.messages.deadline(), x.rivalry.deadline());
  for (const auto& each : {x.health.deadline(), x.input.deadline(), x.exchange.tables_deadline(),
                           x.beats.deadline(), x.tracer.deadline()})
    next = earliest(next, each);
  if (x.own.left)
    return next;
  for (const auto& each : {x.updates.loss_deadline(), x.clock.deadline(), x.adapters.deadline(),
                           x.dials.deadline(), x.announcements.deadline(), x.matches.deadline(),
                           x.inquiry.deadline(), x.exchange.deadline()})
    next = earliest(next, each);
  return next;
}

bool p2p::serve_next(instant now) {
  const auto link = parts_->input.next(now);
  if (link)
    parts_->serve(parts_->links.at(*link), now);
  return link.has_value();
}

/// Handles what a link has brought until its credit is used up or there is no whole package left.
void p2p::parts::serve(connection& from, instant now) {
  const auto link = from.id;
  const auto its = at(now).over(link);
  // What is decoded must outlive the connection, which a package may close.
  auto decoder = std::exchange(from.in.decoder, {});
  if (!from.open) {
    if (const auto request = decoder.take_connect_request())
      greeting.accept(from, *request, its);
  }
  bool more = false;
  auto* x = links.find(link);
  for (; x != nullptr && x->open; x = links.find(link)) {
    more = !link_input::may_go_on(*x, now);
    const auto package = more ? std::nullopt : decoder.next();
    if (!package)
      break;
    link_input::note_package(*x, *package, now);
    const acting_on content(carries_content(package->header.port)
                                ? package_comes(name_of(package->header))
                                : provenance());
    packages.on_package(link, package->header, package->data, its);
    input.charge(link, own.work.take(), now);
    input.spend(link, 1);
  }
  if (x == nullptr)
    return;
  const bool broken = decoder.broken();
  x->in.decoder = std::move(decoder);
  if (broken)
    closer.close_broken({link}, close_cause::bad_stream, at(now));
  else
    input.finish(*x, more && x->in.decoder.has_more(), now, out);
}

bool p2p::has_input() const {
  return !parts_->input.empty();
}

void p2p::end_turn(instant now) {
  if (const auto link = parts_->input.end_turn(now, parts_->out))
    parts_->closer.close_broken({*link}, close_cause::over_budget, parts_->at(now));
}

void p2p::charge(link_id link, work_units work, instant now) {
  parts_->input.charge(link, work, now);
}

void p2p::send(posting x) {
  parts_->messages.send(std::move(x), own_origin, parts_->out);
}

cause p2p::broadcast(std::uint16_t port, payload octets) {
  return parts_->sender.broadcast(port, std::move(octets), own_origin);
}

void p2p::share_memory(std::shared_ptr<fair_share> x) {
  parts_->messages.share_memory(std::move(x));
}

void p2p::set_transit_hook(std::uint16_t port, transit_hook hook) {
  parts_->hooks.set(port, std::move(hook));
}

void p2p::leave() {
  auto& own = parts_->own;
  if (own.left)
    return;
  static_cast<void>(broadcast(
      port::dead_host, encode(dead_host_message{own.self.id, dead_host_message::reason::route})));
  own.left = true;
  parts_->rivalry.end();
  parts_->exchange.cancel();
}

void p2p::set_addresses(std::vector<low_level_address> all, instant now) {
  auto& own = parts_->own;
  const auto before = own.self.addresses;
  own.set_addresses(std::move(all));
  if (own.self.addresses == before || own.left)
    return;
  parts_->announcements.hasten(now);
  for (auto& [id, x] : parts_->links.all()) {
    if (x.neighbour)
      parts_->sender.send_to_neighbour(x, port::host_record,
                                       encode(host_record_message{own.self, false}), own_origin);
  }
}

void p2p::trace(peer_id destination, request_id id, instant now) {
  const auto self = parts_->own.self.id;
  if (destination == self)
    parts_->out.push_back(traced{id, destination, {self}});
  else if (parts_->own.left || !parts_->routes.reachable(destination))
    parts_->out.push_back(traced{id, destination, {}});
  else
    parts_->tracer.trace(destination, id, now);
}

void p2p::step_clock(duration by, instant now) {
  parts_->clock.clock().step(by, now);
}

events p2p::take_events() {
  return std::exchange(parts_->out, {});
}

void p2p::flush(instant now) {
  auto& x = *parts_;
  x.messages.repeat_due(now, x.out);
  x.messages.acknowledge_due(now);
  x.inquiry.ask_due(now);
  x.exchange.send_due(x.at(now));
  for (bool progress = true; progress;) {
    progress = false;
    for (auto& [link, each] : x.links.all())
      progress = x.writer.write(each, now, x.out) || progress;
    x.messages.begin_stale_anew(x.out);
    x.messages.continue_stalled(x.out);
  }
}

p2p_view p2p::view() const {
  const auto& x = *parts_;
  return {x.own, x.links, x.hosts, x.routes, x.clock.clock(), x.adapters};
}

} // namespace rubicon::peis
