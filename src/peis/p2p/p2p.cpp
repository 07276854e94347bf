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

/// What a peer knows: of itself, its links, hosts and routes (peis/overlay).
struct known_parts {
  known_parts(p2p_config config, random_stream rng, instant now)
      : own(std::move(config), rng), rivalry(own.self.magic, now),
        adapters(own.config.bluetooth, now), traffic(own.config.tables.routes, now),
        seen(own.config.tables.seen, own.rng), links(own.config), routes(own, links),
        hosts(own, links, routes) {}

  own_peer own;
  id_rivalry rivalry;
  bluetooth adapters;
  traffic_meter traffic;
  seen_ids seen;
  transit_hooks hooks;
  link_table links;
  overlay routes;
  host_table hosts;
};

/// What links send and receive (peis/links).
struct link_parts {
  link_parts(known_parts& x, instant now)
      : input(x.own, x.links, now), sender(x.own, x.links), health(x.own, x.links, x.hosts),
        beats(x.own, x.links, x.hosts, health, sender),
        messages(x.own, x.links, x.routes, sender, x.traffic), writer(x.own, health, messages),
        announcements(x.own, x.rivalry, x.hosts, now), contacts(x.own, x.links, x.hosts),
        dials(x.own, x.links, x.routes, x.hosts, contacts, x.adapters, now) {}

  link_input input;
  package_sender sender;
  link_health health;
  heartbeats beats;
  message_delivery messages;
  link_writer writer;
  announcer announcements;
  contact_history contacts;
  dialler dials;
};

/// Requests and reports about hosts and routes (peis/hosts).
struct host_parts {
  host_parts(known_parts& x, link_parts& link, instant now)
      : exchange(x.own, x.links, x.routes, link.sender, now),
        tracer(x.own, x.links, x.routes, link.sender),
        clock(x.own, x.links, x.hosts, link.sender, now),
        inquiry(x.own, x.links, x.routes, x.hosts, link.sender, link.messages),
        presence({x.own, x.routes, exchange, x.hosts, inquiry, link.messages, tracer, link.contacts,
                  x.traffic, link.announcements}) {}

  routing_exchange exchange;
  route_tracer tracer;
  clock_service clock;
  host_inquiry inquiry;
  host_presence presence;
};

/// Links that open and close, hosts that come and go (peis/p2p).
struct change_parts {
  change_parts(known_parts& x, link_parts& link, host_parts& host, instant now)
      : closer({x.own, x.links, link.input, link.health, x.seen, link.contacts, link.dials,
                link.messages, x.routes, host.presence}),
        removal({x.own, x.links, x.routes, host.exchange, x.hosts, link.contacts, host.presence,
                 closer}),
        replacer(x.own, x.links, x.hosts, link.health, link.sender, link.dials, closer),
        guard(x.own, x.links, x.hosts, link.sender, link.writer, closer),
        duplicates({x.own, x.rivalry, x.links, x.routes, host.exchange, x.hosts, link.dials,
                    host.presence, closer, removal}),
        matches({x.own, x.links, x.routes, host.exchange, x.hosts, link.health, link.contacts,
                 x.traffic, link.dials, closer},
                now),
        greeting({x.own, x.rivalry, x.links, x.routes, host.exchange, x.hosts, link.sender,
                  link.writer, link.health, link.beats, link.dials, host.presence, closer,
                  matches}),
        records({x.own, x.links, x.routes, host.exchange, x.hosts, host.inquiry, link.contacts,
                 link.dials, link.beats, link.announcements, host.presence, removal, guard,
                 duplicates, matches}),
        names({x.own, x.links, x.routes, x.hosts, link.sender, link.writer, link.health, link.dials,
               host.presence, closer, guard, duplicates, greeting, records}),
        updates({x.own, x.links, x.routes, host.exchange, x.hosts, host.inquiry, host.presence,
                 removal, replacer}),
        packages({x.own, x.links, x.routes, x.seen, link.sender, x.traffic, link.messages, x.hooks,
                  host.tracer, host.clock, link.beats, host.inquiry, guard, duplicates, records,
                  names, updates}) {}

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

/// Later ones refer to earlier ones.
struct p2p::parts {
  parts(p2p_config config, random_stream rng, instant now)
      : known(std::move(config), rng, now), link_layer(known, now),
        host_layer(known, link_layer, now), changes(known, link_layer, host_layer, now) {}

  [[nodiscard]] occasion at(instant now) { return {now, out}; }
  [[nodiscard]] bool is_away() const { return known.rivalry.is_away() && !known.own.left; }
  void apply(bluetooth::outputs todo);
  void serve(connection& from, instant now);
  void tend_links(const occasion& x);
  void tend_hosts(const occasion& x);
  void tend_connections(const occasion& x);

  events out;
  known_parts known;
  link_parts link_layer;
  host_parts host_layer;
  change_parts changes;
};

p2p::p2p() : p2p(p2p_config(), random_stream(), instant()) {}
p2p::p2p(p2p_config config, random_stream rng, instant now)
    : parts_(std::make_unique<parts>(std::move(config), rng, now)) {}
p2p::~p2p() = default;
p2p::p2p(p2p&&) noexcept = default;
p2p& p2p::operator=(p2p&&) noexcept = default;

void p2p::on_link_open(link_id link, link_role role, instant now,
                       std::optional<attempt_id> attempt) {
  if (parts_->changes.greeting.open(link, role, attempt, parts_->at(now)))
    parts_->link_layer.input.note_time(now);
}

void p2p::on_attempt_failed(attempt_id attempt, instant now) {
  parts_->link_layer.dials.on_attempt_failed(attempt, now);
}

void p2p::on_announcement(byte_view octets, instant now, std::optional<ipv4_address> from) {
  parts_->changes.records.on_announcement(octets, from, parts_->at(now));
}

void p2p::parts::apply(bluetooth::outputs todo) {
  if (todo.empty())
    return;
  const auto hello = known.own.hello();
  for (auto& x : todo)
    out.push_back(event_of(x, hello));
}

void p2p::on_bluetooth_scan(std::string_view adapter, std::span<const seen_device> seen,
                            instant now) {
  if (!parts_->known.own.left)
    parts_->apply(parts_->known.adapters.on_scan(adapter, seen, now));
}

/// A peer of another network answers as well; its record is of no use to us.
void p2p::on_hello_answer(std::string_view adapter, const bluetooth_address& address,
                          byte_view octets, instant now) {
  if (parts_->known.own.left)
    return;
  const bool is_peer = static_cast<bool>(decode_announcement(octets));
  parts_->apply(parts_->known.adapters.on_answer(adapter, address, is_peer, now));
  if (is_peer)
    on_announcement(octets, now);
}

void p2p::on_link_octets(link_id link, byte_view octets, instant now) {
  if (auto* x = parts_->known.links.find(link))
    parts_->link_layer.input.on_octets(*x, octets, now);
}

void p2p::on_link_sent(link_id link, std::size_t octets, instant now) {
  if (auto* x = parts_->known.links.find(link))
    parts_->link_layer.writer.on_sent(*x, octets, now);
}

void p2p::on_link_closed(link_id link, instant now) {
  if (auto* x = parts_->known.links.find(link))
    parts_->changes.closer.on_closed(*x, parts_->at(now));
}

void p2p::on_time(instant now) {
  auto& x = *parts_;
  const auto at = x.at(now);
  x.link_layer.input.note_time(now);
  x.changes.duplicates.on_time(at);
  if (x.is_away())
    return;
  if (!x.known.own.left)
    x.changes.updates.on_period(at);
  x.link_layer.messages.on_time(now);
  x.tend_links(at);
  x.changes.updates.apply_waiting(at);
  x.tend_hosts(at);
  x.tend_connections(at);
}

void p2p::parts::tend_links(const occasion& x) {
  for (const auto& [link, why] : link_layer.health.take_silent(x.now)) {
    ++(why == close_cause::silent ? known.own.counters.links_broken
                                  : known.own.counters.links_refused);
    changes.closer.close(link, why, x);
  }
}

/// Signs of life, proof of routes, the clock.
void p2p::parts::tend_hosts(const occasion& x) {
  link_layer.beats.on_time(x.now);
  for (const auto& each : host_layer.tracer.probe_due(x.now))
    changes.updates.disprove(each, x);
  host_layer.tracer.end_late_traces(x);
  if (known.own.left)
    return;
  changes.updates.remove_lost(x);
  host_layer.clock.on_time(x.now);
}

void p2p::parts::tend_connections(const occasion& x) {
  if (known.own.left)
    return;
  link_layer.dials.on_time(x.now);
  apply(known.adapters.on_time(x.now));
  link_layer.dials.dial_standing(x);
  link_layer.announcements.on_time(x);
  changes.matches.on_time(x);
  changes.replacer.on_time(x);
}

std::optional<instant> p2p::deadline() const {
  const auto& x = *parts_;
  if (x.is_away())
    return x.known.rivalry.deadline();
  auto next = earliest(x.link_layer.messages.deadline(), x.known.rivalry.deadline());
  for (const auto& each : {x.link_layer.health.deadline(), x.link_layer.input.deadline(),
                           x.host_layer.exchange.tables_deadline(), x.link_layer.beats.deadline(),
                           x.host_layer.tracer.deadline()})
    next = earliest(next, each);
  if (x.known.own.left)
    return next;
  for (const auto& each : {x.changes.updates.loss_deadline(), x.host_layer.clock.deadline(),
                           x.known.adapters.deadline(), x.link_layer.dials.deadline(),
                           x.link_layer.announcements.deadline(), x.changes.matches.deadline(),
                           x.host_layer.inquiry.deadline(), x.host_layer.exchange.deadline()})
    next = earliest(next, each);
  return next;
}

bool p2p::serve_next(instant now) {
  const auto link = parts_->link_layer.input.next(now);
  if (link)
    parts_->serve(parts_->known.links.at(*link), now);
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
      changes.greeting.accept(from, *request, its);
  }
  bool more = false;
  auto* x = known.links.find(link);
  for (; x != nullptr && x->open; x = known.links.find(link)) {
    more = !link_input::may_go_on(*x, now);
    const auto package = more ? std::nullopt : decoder.next();
    if (!package)
      break;
    link_input::note_package(*x, *package, now);
    const acting_on content(carries_content(package->header.port)
                                ? package_comes(name_of(package->header))
                                : provenance());
    changes.packages.on_package(link, package->header, package->data, its);
    link_layer.input.charge(link, known.own.work.take(), now);
    link_layer.input.spend(link, 1);
  }
  if (x == nullptr)
    return;
  const bool broken = decoder.broken();
  x->in.decoder = std::move(decoder);
  if (broken)
    changes.closer.close_broken({link}, close_cause::bad_stream, at(now));
  else
    link_layer.input.finish(*x, more && x->in.decoder.has_more(), now, out);
}

bool p2p::has_input() const {
  return !parts_->link_layer.input.empty();
}

void p2p::end_turn(instant now) {
  if (const auto link = parts_->link_layer.input.end_turn(now, parts_->out))
    parts_->changes.closer.close_broken({*link}, close_cause::over_budget, parts_->at(now));
}

void p2p::charge(link_id link, work_units work, instant now) {
  parts_->link_layer.input.charge(link, work, now);
}

void p2p::send(posting x) {
  parts_->link_layer.messages.send(std::move(x), own_origin, parts_->out);
}

cause p2p::broadcast(std::uint16_t port, payload octets) {
  return parts_->link_layer.sender.broadcast(port, std::move(octets), own_origin);
}

void p2p::share_memory(std::shared_ptr<fair_share> x) {
  parts_->link_layer.messages.share_memory(std::move(x));
}

void p2p::set_transit_hook(std::uint16_t port, transit_hook hook) {
  parts_->known.hooks.set(port, std::move(hook));
}

void p2p::leave() {
  auto& own = parts_->known.own;
  if (own.left)
    return;
  static_cast<void>(broadcast(
      port::dead_host, encode(dead_host_message{own.self.id, dead_host_message::reason::route})));
  own.left = true;
  parts_->known.rivalry.end();
  parts_->host_layer.exchange.cancel();
}

void p2p::set_addresses(std::vector<low_level_address> all, instant now) {
  auto& own = parts_->known.own;
  const auto before = own.self.addresses;
  own.set_addresses(std::move(all));
  if (own.self.addresses == before || own.left)
    return;
  parts_->link_layer.announcements.hasten(now);
  for (auto& [id, x] : parts_->known.links.all()) {
    if (x.neighbour)
      parts_->link_layer.sender.send_to_neighbour(
          x, port::host_record, encode(host_record_message{own.self, false}), own_origin);
  }
}

void p2p::trace(peer_id destination, request_id id, instant now) {
  const auto self = parts_->known.own.self.id;
  if (destination == self)
    parts_->out.push_back(traced{id, destination, {self}});
  else if (parts_->known.own.left || !parts_->known.routes.reachable(destination))
    parts_->out.push_back(traced{id, destination, {}});
  else
    parts_->host_layer.tracer.trace(destination, id, now);
}

void p2p::step_clock(duration by, instant now) {
  parts_->host_layer.clock.clock().step(by, now);
}

events p2p::take_events() {
  return std::exchange(parts_->out, {});
}

void p2p::flush(instant now) {
  auto& x = *parts_;
  x.link_layer.messages.repeat_due(now, x.out);
  x.link_layer.messages.acknowledge_due(now);
  x.host_layer.inquiry.ask_due(now);
  x.host_layer.exchange.send_due(x.at(now));
  for (bool progress = true; progress;) {
    progress = false;
    for (auto& [link, each] : x.known.links.all())
      progress = x.link_layer.writer.write(each, now, x.out) || progress;
    x.link_layer.messages.begin_stale_anew(x.out);
    x.link_layer.messages.continue_stalled(x.out);
  }
}

p2p_view p2p::view() const {
  const auto& x = *parts_;
  return {x.known.own,     x.known.links, x.known.hosts, x.known.routes, x.host_layer.clock.clock(),
          x.known.adapters};
}

} // namespace rubicon::peis
