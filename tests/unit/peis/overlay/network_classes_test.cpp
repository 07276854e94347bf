// Classes of a peer's network layer by themselves: links, next hops, turns, announcements,
// contacts.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "peis/hosts/clock_service.hpp"
#include "peis/hosts/route_tracer.hpp"
#include "peis/hosts/routing_exchange.hpp"
#include "peis/links/announcer.hpp"
#include "peis/links/contact_history.hpp"
#include "peis/links/heartbeats.hpp"
#include "peis/links/link_health.hpp"
#include "peis/links/link_input.hpp"
#include "peis/links/message_delivery.hpp"
#include "peis/overlay/host_table.hpp"
#include "support/catch.hpp"

namespace rubicon::peis {
namespace {

constexpr instant opened_at{1h};
constexpr peer_id near_peer{2};
constexpr peer_id far_peer{3};

p2p_config lone_config(std::int32_t id) {
  p2p_config config;
  config.id = peer_id{id};
  return config;
}

/// What the first classes refer to.
struct lone_layer {
  explicit lone_layer(p2p_config config = lone_config(1))
      : own(std::move(config), random_stream(1)), links(own.config), routes(own, links),
        hosts(own, links, routes) {}

  connection& open(std::uint64_t link, std::optional<peer_id> neighbour = std::nullopt) {
    auto& x = links.add(link_id{link}, opened_at);
    x.open = true;
    if (neighbour)
      links.bind(x, *neighbour);
    return x;
  }
  [[nodiscard]] occasion at(instant now, std::uint64_t over = 0) {
    return {now, out, link_id{over}};
  }

  own_peer own;
  link_table links;
  overlay routes;
  host_table hosts;
  events out;
};

template <class T>
std::size_t number_of(const events& all) {
  return static_cast<std::size_t>(std::count_if(
      all.begin(), all.end(), [](const auto& x) { return std::holds_alternative<T>(x); }));
}

/// Two neighbours, and a host behind both of them, nearer over the first.
struct two_routes : lone_layer {
  two_routes() {
    open(1, near_peer);
    open(2, other_peer);
    learn(1, {{near_peer, 1, 7, 0, 1}, {far_peer, 10, 8, 2, 1}});
    learn(2, {{other_peer, 1, 9, 0, 1}, {far_peer, 10, 8, 4, 1}});
  }

  /// The neighbour at the other end of that link sends its table.
  routing_changes learn(std::uint64_t link, const std::vector<routing_entry>& entries) {
    auto& from = links.at(link_id{link});
    REQUIRE(exchange.on_page(from, encode(paginate(entries, entries.front().seqno).front()),
                             opened_at));
    return exchange.apply(from, opened_at);
  }
  /// The number of a host in our table, as it is sent over that link.
  std::int32_t sent(std::uint64_t link, peer_id host) {
    while (links.at(link_id{link}).out.queue.pop()) { // what was sent before
    }
    exchange.send_to(links.at(link_id{link}), own_origin);
    const auto page = decode_routing_page(next_page(link).view());
    REQUIRE(page);
    const auto entry = std::ranges::find(page->entries, host, &routing_entry::id);
    REQUIRE(entry != page->entries.end());
    return entry->seqno;
  }
  /// The next table that leaves over that link.
  payload next_page(std::uint64_t link) {
    const auto package = links.at(link_id{link}).out.queue.pop();
    REQUIRE(package);
    return package->content->head;
  }

  static constexpr peer_id other_peer{4};
  package_sender sender{own, links};
  routing_exchange exchange{own, links, routes, sender, opened_at};
};

} // namespace

TEST_CASE("of two links to a neighbour the oldest counts, then the other", "[peis]") {
  lone_layer x;
  x.open(7, near_peer);
  x.open(5, near_peer);
  CHECK(x.links.link_to(near_peer) == link_id{7});
  CHECK(x.links.links_to(near_peer).size() == 2);
  CHECK(x.links.take(link_id{7})->id == link_id{7});
  CHECK(x.links.link_to(near_peer) == link_id{5});
  CHECK(x.links.take(link_id{5}));
  CHECK(!x.links.is_neighbour(near_peer));
  CHECK(!x.links.take(link_id{5}));
}

TEST_CASE("without a route the link that a source was last met over is the next hop", "[peis]") {
  auto config = lone_config(1);
  config.tables.heard_over = 1;
  lone_layer x(config);
  x.open(1);
  x.routes.note_source(near_peer, link_id{1});
  CHECK(!x.routes.reachable(near_peer));
  CHECK(x.routes.any_hop(near_peer) == link_id{1});
  x.routes.note_source(far_peer, link_id{1}); // the table of this link has room for one
  CHECK(!x.routes.any_hop(near_peer));
  CHECK(x.routes.on_link_closed(link_id{1}, opened_at).empty());
  CHECK(!x.routes.any_hop(far_peer));
}

TEST_CASE("a link may bring as many hosts as are free beside them", "[peis]") {
  auto config = lone_config(1);
  config.tables.hosts = 4;
  lone_layer x(config);
  x.open(1);
  x.open(2);
  std::size_t admitted = 0;
  for (std::int32_t id = 10; id < 20; ++id)
    admitted += x.hosts.admit(peer_id{id}, x.at(opened_at, 1)) != nullptr ? 1 : 0;
  CHECK(admitted == 2);
  CHECK(x.own.counters.hosts_refused == 8);
  CHECK(x.hosts.admit(peer_id{30}, x.at(opened_at, 2)) != nullptr);
  CHECK(x.hosts.admit(peer_id{30}, x.at(opened_at, 1)) != nullptr); // known
}

TEST_CASE("links take turns, and one over its budget waits for it", "[peis]") {
  auto config = lone_config(1);
  config.turn_work = 4;
  config.budget.work_per_second = 10;
  config.budget.burst = 100ms;
  lone_layer x(config);
  link_input input(x.own, x.links, opened_at);
  auto& first = x.open(1);
  auto& second = x.open(2);
  const bytes octets(10);
  input.on_octets(first, octets, opened_at);
  input.on_octets(second, octets, opened_at);
  CHECK(input.deadline() == opened_at);
  CHECK(input.next(opened_at) == link_id{1});
  input.charge(link_id{1}, 5, opened_at);
  CHECK(x.own.counters.work == 5);
  CHECK(!input.next(opened_at)); // the turn's work is done
  input.finish(first, true, opened_at, x.out);
  CHECK(x.own.counters.rests == 1);
  CHECK(!input.end_turn(opened_at, x.out));
  CHECK(number_of<read_link>(x.out) == 1);
  CHECK(input.next(opened_at) == link_id{2});
  input.finish(second, false, opened_at, x.out);
  REQUIRE(input.deadline());
  CHECK(*input.deadline() > opened_at);
  CHECK(!input.next(opened_at));
  CHECK(input.next(*input.deadline()) == link_id{1});
}

TEST_CASE("of many hosts each announces more rarely, and not all at once", "[peis][TCP-03]") {
  lone_layer x;
  const id_rivalry rivalry(x.own.self.magic, opened_at);
  announcer announcements(x.own, rivalry, x.hosts, opened_at);
  const auto mean_period = [&] {
    const auto from = *announcements.deadline();
    for (int i = 0; i < 200; ++i)
      announcements.on_time(x.at(*announcements.deadline()));
    return (*announcements.deadline() - from) / 200;
  };
  const auto admit_up_to = [&](std::int32_t last) {
    for (std::int32_t id = 100; id < 100 + last; ++id)
      REQUIRE(x.hosts.admit(peer_id{id}, x.at(opened_at, 1)) != nullptr);
  };
  x.open(1);
  admit_up_to(49);
  CHECK(mean_period() == 1s);
  admit_up_to(100);
  CHECK(mean_period() > 3900ms);
  CHECK(mean_period() < 4100ms);
  const auto before = *announcements.deadline();
  announcements.on_time(x.at(before));
  CHECK(*announcements.deadline() - before != 4s);
  admit_up_to(1000);
  CHECK(mean_period() > 28s);
  CHECK(mean_period() < 32s);
}

TEST_CASE("in a large network a changed cluster is announced within a second, once",
          "[peis][NFR-06]") {
  lone_layer x;
  const id_rivalry rivalry(x.own.self.magic, opened_at);
  announcer announcements(x.own, rivalry, x.hosts, opened_at);
  x.open(1);
  for (std::int32_t id = 100; id < 160; ++id)
    REQUIRE(x.hosts.admit(peer_id{id}, x.at(opened_at, 1)) != nullptr);
  auto last = opened_at;
  for (int i = 0; i < 4; ++i) {
    last = *announcements.deadline();
    announcements.on_time(x.at(last));
  }
  REQUIRE(number_of<announce>(x.out) == 4);
  announcements.announce_now(x.at(last + 100ms));
  announcements.announce_now(x.at(last + 200ms));
  CHECK(number_of<announce>(x.out) == 4);
  CHECK(*announcements.deadline() == last + 1100ms);
  announcements.on_time(x.at(last + 1100ms));
  CHECK(number_of<announce>(x.out) == 5);
}

TEST_CASE("in a large network broadcasts of the clock begin at different times, and go on",
          "[peis][NFR-06]") {
  lone_layer x;
  package_sender sender(x.own, x.links);
  clock_service clock(x.own, x.links, x.hosts, sender, opened_at);
  auto& queue = x.open(1).out.queue;
  const auto due = *clock.deadline();
  SECTION("many hosts") {
    for (std::int32_t id = 100; id < 160; ++id)
      REQUIRE(x.hosts.admit(peer_id{id}, x.at(opened_at, 1)) != nullptr);
    clock.on_time(due);
    CHECK(!queue.pop());
    CHECK(*clock.deadline() > due);
    CHECK(*clock.deadline() <= due + x.own.config.clock_period);
    clock.on_time(*clock.deadline());
    CHECK(queue.pop());
    clock.on_time(*clock.deadline());
    CHECK(queue.pop());
  }
  SECTION("few") {
    clock.on_time(due);
    CHECK(queue.pop());
  }
}

TEST_CASE("the end of a link moves routes to ones that may lead back to us", "[peis][RTE-06]") {
  two_routes x;
  static_cast<void>(x.routes.on_link_closed(link_id{1}, opened_at));
  REQUIRE(x.routes.routes().way_to(far_peer) == link_id{2});
  CHECK(x.routes.routes().is_unsound(far_peer));
}

TEST_CASE("what comes over a link that is to be closed is no news, so that its end is none",
          "[peis][RTE-06][NFR-06]") {
  two_routes x;
  x.exchange.drain(link_id{1}, opened_at + 20s);
  static_cast<void>(x.learn(1, {{near_peer, 2, 7, 0, 1}, {far_peer, 11, 8, 2, 1}}));
  static_cast<void>(x.learn(2, {{x.other_peer, 2, 9, 0, 1}, {far_peer, 11, 8, 4, 1}}));
  REQUIRE(x.routes.routes().way_to(far_peer) == link_id{1});
  CHECK(x.routes.routes().find(far_peer)->seqno == 10);
  SECTION("its end") {
    static_cast<void>(x.routes.on_link_closed(link_id{1}, opened_at));
    REQUIRE(x.routes.routes().way_to(far_peer) == link_id{2});
    CHECK(!x.routes.routes().is_unsound(far_peer));
  }
  SECTION("nor is it for the neighbour") {
    CHECK(x.sent(1, x.other_peer) == 1);
    CHECK(x.sent(2, near_peer) == 1); // as it came
    x.exchange.end_drain(link_id{1});
    CHECK(x.sent(1, x.other_peer) == 2);
  }
  SECTION("another incarnation is news") {
    const auto changes = x.learn(1, {{near_peer, 3, 7, 0, 1}, {far_peer, 1, 88, 2, 1}});
    REQUIRE(changes.size() == 1);
    CHECK(changes[0].what == routing_change::kind::reborn);
  }
  SECTION("a host that is gone is") {
    CHECK(!x.learn(1, {{near_peer, 3, 7, 0, 1}}).empty());
    CHECK(x.routes.routes().way_to(far_peer) == link_id{2});
  }
}

TEST_CASE("the neighbour at the other end of a link that is to be closed knows it at once",
          "[peis][CM-01][NFR-06]") {
  two_routes x;
  lone_layer neighbour(lone_config(near_peer.value));
  package_sender sender(neighbour.own, neighbour.links);
  routing_exchange exchange(neighbour.own, neighbour.links, neighbour.routes, sender, opened_at);
  auto& link = neighbour.open(1, x.own.self.id);
  const auto was_drained = [&] {
    static_cast<void>(exchange.on_page(link, x.next_page(1).view(), opened_at));
    return link.routes.drained;
  };
  x.exchange.send({opened_at, x.out});
  CHECK(!was_drained());
  x.exchange.drain(link_id{1}, opened_at + 20s);
  CHECK(was_drained());
  x.exchange.send({opened_at, x.out});
  CHECK(was_drained());
  x.exchange.end_drain(link_id{1});
  x.exchange.send({opened_at, x.out});
  CHECK(!was_drained());
}

TEST_CASE("a host in doubt is asked over each link that it is offered over, the best first",
          "[peis][RTE-07]") {
  two_routes x;
  route_tracer tracer(x.own, x.links, x.routes, x.sender);
  auto& routes = x.routes.routes();
  routes.mark(far_peer);
  static_cast<void>(x.learn(2, {{x.other_peer, 2, 9, 0, 1}}));
  static_cast<void>(x.learn(1, {{near_peer, 2, 7, 0, 1}}));
  REQUIRE(!x.routes.reachable(far_peer));
  static_cast<void>(x.learn(1, {{near_peer, 3, 7, 0, 1}, {far_peer, 12, 8, 2, 1}}));
  static_cast<void>(x.learn(2, {{x.other_peer, 3, 9, 0, 1}, {far_peer, 12, 8, 4, 1}}));
  REQUIRE(routes.offers_of(far_peer).size() == 2);
  REQUIRE(!x.routes.reachable(far_peer));
  tracer.probe_unsound(opened_at);
  const auto asked_over = [&x](std::uint64_t link) {
    std::size_t packages = 0;
    while (x.links.at(link_id{link}).out.queue.pop())
      ++packages;
    return packages;
  };
  for (const std::uint64_t expected : {1U, 2U, 1U, 2U}) {
    CHECK(tracer.probe_due(*tracer.deadline()).empty());
    CHECK(asked_over(expected) == 1);
    CHECK(asked_over(3 - expected) == 0);
  }
  std::vector<way_disproved> silent;
  while (tracer.deadline())
    silent = tracer.probe_due(*tracer.deadline());
  REQUIRE(silent.size() == 1);
  CHECK(silent[0].host == far_peer);
}

TEST_CASE("in a large network a heartbeat that is almost due leaves with one that is",
          "[peis][KH-05][NFR-06]") {
  const bool large = GENERATE(false, true);
  lone_layer x;
  for (std::int32_t id = 2; id < (large ? 60 : 10); ++id) {
    auto* host = x.hosts.admit(peer_id{id}, x.at(opened_at, 1));
    REQUIRE(host != nullptr);
    host->record.marked = true;
  }
  package_sender sender(x.own, x.links);
  link_health health(x.own, x.links, x.hosts);
  heartbeats beats(x.own, x.links, x.hosts, health, sender);
  for (const std::uint64_t link : {2U, 3U, 4U}) { // one after the other, 0.2 s apart
    auto& each = x.open(link, peer_id{static_cast<std::int32_t>(link)});
    each.out.last_written = each.signs.beat_sent = opened_at + (link - 2) * 200ms;
    beats.expect(each);
  }
  std::size_t wakeups = 0;
  std::size_t sent = 0;
  for (; *beats.deadline() <= opened_at + 10s; ++wakeups) {
    beats.on_time(*beats.deadline());
    for (const std::uint64_t link : {2U, 3U, 4U}) {
      while (x.links.at(link_id{link}).out.queue.pop())
        ++sent;
    }
  }
  CHECK(sent >= 28);
  CHECK(sent <= 30);
  CHECK(wakeups == (large ? 10U : 28U));
}

TEST_CASE("a table after a change that no other has to know waits longer in a large network",
          "[peis][NFR-06]") {
  const auto waits = [](std::int32_t hosts) {
    two_routes x;
    std::vector<routing_entry> entries{{near_peer, 2, 7, 0, 1}};
    for (std::int32_t id = 100; id < 100 + hosts; ++id)
      entries.push_back({peer_id{id}, 1, 1, 2, 1});
    entries.resize(std::min(entries.size(), entries_per_page));
    static_cast<void>(x.learn(1, entries));
    events out;
    x.exchange.trigger(opened_at);
    x.exchange.send({opened_at, out});
    x.exchange.trigger_calmly(opened_at);
    const auto calm = *x.exchange.deadline() - opened_at;
    x.exchange.trigger(opened_at);
    CHECK(*x.exchange.deadline() == opened_at + 500ms);
    return calm;
  };
  CHECK(waits(10) == 500ms);
  CHECK(waits(60) == 1s);
}

TEST_CASE("a peer announces itself three times, then only without a better one", "[peis]") {
  lone_layer x;
  const id_rivalry rivalry(x.own.self.magic, opened_at);
  announcer announcements(x.own, rivalry, x.hosts, opened_at);
  for (int i = 0; i < 3; ++i)
    announcements.on_time(x.at(*announcements.deadline()));
  CHECK(number_of<announce>(x.out) == 3);
  announcements.on_better_announcer();
  announcements.on_time(x.at(*announcements.deadline()));
  CHECK(number_of<announce>(x.out) == 3);
  announcements.announce_now(x.at(opened_at + 4s));
  CHECK(number_of<announce>(x.out) == 3);
  for (int i = 0; i < 2; ++i)
    announcements.on_time(x.at(*announcements.deadline()));
  CHECK(number_of<announce>(x.out) == 4);
  x.own.left = true;
  announcements.announce_now(x.at(opened_at + 9s));
  CHECK(number_of<announce>(x.out) == 4);
}

TEST_CASE("a host is tried ever more rarely, and not while it is a neighbour", "[peis]") {
  lone_layer x;
  contact_history contacts(x.own, x.links, x.hosts);
  CHECK(contacts.may_try(near_peer, 30, opened_at));
  contacts.note_contact(near_peer, opened_at);
  CHECK(!contacts.may_try(near_peer, 30, opened_at + 999ms));
  CHECK(contacts.may_try(near_peer, 30, opened_at + 1s));
  contacts.note_contact(near_peer, opened_at + 1s);
  CHECK(!contacts.may_try(near_peer, 30, opened_at + 2s));
  CHECK(contacts.may_try(near_peer, 1, opened_at + 2s));
  CHECK(contacts.may_try(near_peer, 30, opened_at + 3s));
  contacts.forget(near_peer);
  x.open(1, near_peer);
  CHECK(!contacts.may_try(near_peer, 30, opened_at + 1h));
}

TEST_CASE("a link is silent when nothing comes, or nothing leaves", "[peis]") {
  lone_layer x;
  link_health health(x.own, x.links, x.hosts);
  auto& first = x.open(1);
  first.in.octets = 1;
  health.watch_silence(first);
  CHECK(health.deadline() == opened_at + x.own.config.link_timeout);
  CHECK(health.take_silent(opened_at + 29s).empty());
  first.in.last_package = opened_at + 10s;
  CHECK(health.take_silent(opened_at + 30s).empty());
  first.out.unreported = 1;
  first.out.drained = opened_at + 5s;
  const auto silent = health.take_silent(opened_at + 40s);
  REQUIRE(silent.size() == 1);
  CHECK(silent[0].second == close_cause::silent);
}

TEST_CASE("what a queue does not take is counted, and its sender is notified", "[peis]") {
  auto config = lone_config(1);
  config.queue.packages = 1;
  lone_layer x(config);
  package_sender sender(x.own, x.links);
  traffic_meter traffic(10, opened_at);
  message_delivery messages(x.own, x.links, x.routes, sender, traffic);
  x.open(1, near_peer);
  const auto send = [&](peer_id to) {
    messages.send({to, 20, {payload(bytes(5)), {}}, false, priority::normal, request_id{1}},
                  own_origin, x.out);
  };
  send(far_peer);
  REQUIRE(number_of<undelivered>(x.out) == 1);
  CHECK(std::get<undelivered>(x.out[0]).why == cause::no_route);
  send(near_peer);
  CHECK(number_of<delivered>(x.out) == 1);
  send(near_peer);
  CHECK(number_of<undelivered>(x.out) == 2);
  CHECK(x.own.counters.queue_full + x.own.counters.early_drop == 1);
}

} // namespace rubicon::peis
