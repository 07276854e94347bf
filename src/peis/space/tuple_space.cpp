#include "peis/space/tuple_space.hpp"

#include "peis/space/held_tuples.hpp"
#include "peis/space/own_tuples.hpp"
#include "peis/space/subscriber_feed.hpp"
#include "peis/space/tuple_hosts.hpp"
#include "peis/wire/package.hpp"

namespace rubicon::peis {

namespace {

// What is kept of a host that may come back.
constexpr std::size_t suspended_subscriptions_max = 256;
constexpr std::size_t suspended_octets_max = std::size_t{1} << 18U;

} // namespace

struct tuple_space::parts {
  parts(const tuple_space_config& limits, peer_id id, duration clock_offset)
      : config(limits), self(id), clock(clock_offset),
        memory(std::make_shared<fair_share>(limits.others_octets_max)),
        store({limits.written_octets_max, limits.held_octets_max, memory}), drafts(id, clock),
        hosts(limits.strangers_max, limits.stranger_age),
        local(id, limits.subscriptions_max, limits.lifetime), own(limits, id, store, hosts, clock),
        held(limits, id, store, hosts, local, clock), feed(limits, id, own, hosts, local, memory) {}

  void publish(const std::optional<own_change>& change, instant now, tuple_events& out);
  void notify(const own_value_deleted& x, tuple_events& out) { local.notify_deleted(x.gone, out); }
  void notify(const auto& x, tuple_events& out) { local.notify_changed(x.content, out); }
  [[nodiscard]] cause append(const tuple_pointer& x, const payload& added,
                             std::optional<peer_id> writer, instant now, tuple_events& out);
  void on_subscribe(peer_id source, byte_view octets, instant now, tuple_events& out);
  void on_unsubscribe(peer_id source, byte_view octets);
  void on_append_request(peer_id source, const payload& octets, instant now, tuple_events& out);
  void forget_host(peer_id host, instant now, tuple_events& out);

  tuple_space_config config;
  peer_id self;
  tuple_clock clock;
  std::shared_ptr<fair_share> memory; ///< octets of all that others have put here
  tuple_store store;
  tuple_drafts drafts;
  tuple_hosts hosts;
  local_subscriptions local;
  own_tuples own;
  held_tuples held;
  subscriber_feed feed;
  tuple_counters counters; ///< what none of them counts
};

tuple_space::tuple_space() : tuple_space({}, {}, {}) {}
tuple_space::tuple_space(const tuple_space_config& config, peer_id self, duration clock_offset)
    : parts_(std::make_unique<parts>(config, self, clock_offset)) {}
tuple_space::~tuple_space() = default;
tuple_space::tuple_space(tuple_space&&) noexcept = default;
tuple_space& tuple_space::operator=(tuple_space&&) noexcept = default;

void tuple_space::parts::publish(const std::optional<own_change>& change, instant now,
                                 tuple_events& out) {
  if (!change)
    return;
  feed.publish(*change, now, out);
  std::visit([&](const auto& x) { notify(x, out); }, *change);
}

cause tuple_space::parts::append(const tuple_pointer& x, const payload& added,
                                 std::optional<peer_id> writer, instant now, tuple_events& out) {
  const auto result = own.append(x, added, writer, feed.takes_notices(*x));
  publish(result.change, now, out);
  return result.why;
}

std::pair<cause, tuple_events> tuple_space::set(const key& name, tuple_content content,
                                                instant now) {
  tuple_events out;
  const auto result = parts_->own.set(name, std::move(content), now);
  parts_->publish(result.change, now, out);
  return {result.why, std::move(out)};
}

std::pair<cause, tuple_events> tuple_space::insert(tuple x, instant now) {
  tuple_events out;
  const auto result = parts_->own.insert(std::move(x), now);
  parts_->publish(result.change, now, out);
  return {result.why, std::move(out)};
}

tuple_events tuple_space::remove(const key& name, instant now) {
  tuple_events out;
  parts_->publish(parts_->own.remove(name, now), now, out);
  return out;
}

std::pair<cause, tuple_events> tuple_space::append(const prototype& wanted, const payload& added,
                                                   instant now) {
  tuple_events out;
  auto why = cause::none;
  auto own = wanted;
  own.owner = parts_->self;
  for (const auto& x : parts_->store.find_all(own)) {
    if (const auto failed = parts_->append(x, added, {}, now, out); failed != cause::none)
      why = failed;
  }
  return {why, std::move(out)};
}

std::pair<cause, tuple_events> tuple_space::subscribe(const prototype& wanted, subscription_id id,
                                                      interest kind, instant now) {
  const auto added = parts_->local.add(wanted, id, kind);
  if (added.why != cause::none) {
    ++parts_->counters.refused;
    return {added.why, {}};
  }
  if (kind == interest::callback)
    return {};
  tuple_events out;
  for (auto& held : parts_->store.find_all(wanted))
    out.push_back(tuple_changed{id, std::move(held)});
  parts_->feed.ask(added.unasked, now, out);
  return {cause::none, std::move(out)};
}

std::pair<cause, tuple_events> tuple_space::unsubscribe(subscription_id id) {
  tuple_events out;
  const auto gone = parts_->local.remove(id);
  if (!gone)
    return {cause::bad_handle, {}};
  if (gone->kind == interest::callback)
    return {};
  // The message names owner and key only: it would end the others of that name too.
  const auto owner = gone->wanted.owner;
  if (!parts_->local.subscribes_to(owner, gone->wanted.name)) {
    auto message = encode_unsubscribe(gone->wanted);
    if (owner == any_peer)
      out.push_back(transmit_all{port::unsubscribe, std::move(message)});
    else if (parts_->hosts.knows(owner))
      out.push_back(transmit{owner, port::unsubscribe, {std::move(message), {}}, no_request});
  }
  parts_->held.on_unsubscribed(gone->wanted);
  return {cause::none, std::move(out)};
}

tuple_events tuple_space::on_message(std::uint16_t port, peer_id source, const payload& octets,
                                     instant now) {
  tuple_events out;
  switch (port) {
  case port::push:
    parts_->held.on_push(source, octets, now, out);
    break;
  case port::append_notice:
    parts_->held.on_append_notice(source, octets, now, out);
    break;
  case port::append_request:
    parts_->on_append_request(source, octets, now, out);
    break;
  case port::subscribe:
    parts_->on_subscribe(source, octets.view(), now, out);
    break;
  case port::unsubscribe:
    parts_->on_unsubscribe(source, octets.view());
    break;
  }
  return out;
}

void tuple_space::parts::on_subscribe(peer_id source, byte_view octets, instant now,
                                      tuple_events& out) {
  const auto message = decode_subscribe(octets, clock.network_time(now));
  const bool is_for_us =
      message && (message->wanted.owner == any_peer || message->wanted.owner == self);
  if (is_for_us && source != self)
    feed.subscribe(source, message->wanted, message->lifetime, now, out);
  else
    ++counters.malformed;
}

/// Only owner and key of the message mean anything (peis-wire.md 15.2).
void tuple_space::parts::on_unsubscribe(peer_id source, byte_view octets) {
  if (const auto unwanted = decode_unsubscribe(octets))
    feed.unsubscribe(source, unwanted->owner, unwanted->name);
  else
    ++counters.malformed;
}

void tuple_space::parts::on_append_request(peer_id source, const payload& octets, instant now,
                                           tuple_events& out) {
  const auto request = decode_append_request(octets, clock.network_time(now));
  if (!request || request->wanted.owner != self) {
    ++counters.malformed;
    return;
  }
  const auto found = own.find_appendable(request->wanted);
  if (!found) {
    ++counters.appends_refused;
    return;
  }
  if (found->empty() || !hosts.admit(source, now))
    return;
  for (const auto& x : *found) {
    if (x->value.size() + request->added.size() > config.append_octets_max)
      ++counters.appends_refused;
    else
      static_cast<void>(append(x, request->added, source, now, out));
  }
}

std::optional<tuple> tuple_space::decode_set(const payload& octets, instant now) {
  return parts_->own.decode_set(octets, now);
}

tuple_events tuple_space::on_set(peer_id source, const tuple& x, bool may_write, instant now) {
  tuple_events out;
  parts_->publish(parts_->own.on_set(source, x, may_write, now), now, out);
  return out;
}

tuple_events tuple_space::on_host_appeared(peer_id host, bool marked, instant now,
                                           std::int32_t incarnation) {
  tuple_events out;
  const auto resumed = parts_->hosts.appear(host, marked, incarnation);
  parts_->feed.on_host_appeared(host, now, out);
  for (const auto& wanted : resumed)
    parts_->feed.subscribe(host, wanted, std::nullopt, now, out);
  return out;
}

tuple_events tuple_space::on_host_vanished(peer_id host, instant now) {
  tuple_events out;
  const auto& subscribers = parts_->feed.subscribers();
  parts_->hosts.vanish(
      host, subscribers.lasting_of(host, suspended_subscriptions_max, suspended_octets_max));
  parts_->forget_host(host, now, out);
  return out;
}

/// What it has put here goes; what it wrote into our own tuples stays for a while (orphans).
void tuple_space::parts::forget_host(peer_id host, instant now, tuple_events& out) {
  held.on_owner_gone(host, out);
  feed.on_host_gone(host);
  own.on_writer_gone(host, now);
}

tuple_events tuple_space::renew(peer_id host, instant now) {
  tuple_events out;
  parts_->feed.ask_all(host, true, now, out);
  return out;
}

tuple_events tuple_space::on_delivered(request_id request, instant now) {
  tuple_events out;
  parts_->feed.on_delivered(request, now, out);
  return out;
}

void tuple_space::on_undelivered(peer_id destination, std::uint16_t port, byte_view head,
                                 request_id request, instant now) {
  parts_->feed.on_undelivered(destination, port, head, request, now);
}

tuple_events tuple_space::on_time(instant now) {
  tuple_events out;
  auto& all = *parts_;
  while (const auto gone = all.store.take_expired(now)) {
    ++all.counters.expired;
    if (gone->owner == all.self) {
      all.own.on_expired(*gone);
      all.feed.on_expired(gone->name);
    } else {
      all.held.on_expired(*gone);
    }
    all.local.notify_deleted(gone, out);
  }
  for (const auto host : all.hosts.take_silent(now))
    all.forget_host(host, now, out);
  for (const auto& name : all.own.take_orphans(now))
    all.publish(all.own.remove(name, now), now, out);
  all.feed.refresh(now, out);
  all.held.on_time(now, out);
  all.feed.serve_pending(now, out);
  return out;
}

std::optional<instant> tuple_space::deadline() const {
  const auto& all = *parts_;
  const auto of_tuples = earliest(all.store.deadline(), all.held.deadline());
  const auto of_hosts = earliest(all.hosts.deadline(), all.own.deadline());
  return earliest(all.feed.deadline(), earliest(of_tuples, of_hosts));
}

void tuple_space::set_clock_offset(duration offset) {
  parts_->clock.set_offset(offset);
}

const tuple_store& tuple_space::stored() const {
  return parts_->store;
}

tuple_audience tuple_space::audience() const {
  return {parts_->local, parts_->feed.subscribers()};
}

const tuple_drafts& tuple_space::drafts() const {
  return parts_->drafts;
}

bool tuple_space::is_waiting(const key& name) const {
  return parts_->feed.is_waiting(name);
}

std::uint64_t tuple_space::own_keys_version() const {
  return parts_->own.keys_version();
}

tuple_counters tuple_space::counters() const {
  auto all = parts_->counters;
  all += parts_->own.counters();
  all += parts_->held.counters();
  all += parts_->feed.counters();
  all.tuples = parts_->store.size();
  all.held_octets = parts_->store.held().total();
  all.written_octets = parts_->store.written().total();
  all.subscriptions = parts_->local.size();
  all.strangers_refused = parts_->hosts.strangers_refused();
  all.absent_forgotten = parts_->hosts.suspended_forgotten();
  return all;
}

const std::shared_ptr<fair_share>& tuple_space::memory() const {
  return parts_->memory;
}

work_units tuple_space::take_work() {
  return parts_->own.take_work() + parts_->held.take_work() + parts_->feed.take_work();
}

} // namespace rubicon::peis
