// What others can make a tuple space hold: each limit, one beyond it, and who shares it.
#include <set>

#include "unit/peis/tuples/lone_space.hpp"

namespace rubicon::peis {

using namespace test;

TEST_CASE("records of subscribers have a limit that hosts share", "[peis][TUP-08][TUP-24]") {
  tuple_space_config config;
  config.subscribers_max = 10;
  lone_space b(config);
  for (std::size_t i = 0; i < 9; ++i)
    b.subscribe(hostile, numbered("k", i));
  CHECK(b.counted().subscribers == 8);
  CHECK(b.counted().subscribers_refused == 1);
  b.subscribe(robot, "x");
  CHECK(b.counted().subscribers == 9);
  b.subscribe(hostile, "k0"); // what is there may be repeated
  CHECK(b.counted().subscribers_refused == 1);
  b.take(b.x.on_host_vanished(hostile, b.now));
  CHECK(b.counted().subscribers == 1);
  CHECK(b.counted().debtors == 0);
}

TEST_CASE("subscribers have a limit of octets", "[peis][TUP-08][TUP-24]") {
  tuple_space_config config;
  config.subscribers_octets_max = 1'000'000;
  lone_space b(config);
  for (std::size_t i = 0; i < 100; ++i)
    b.take(b.x.on_message(port::subscribe, hostile,
                          subscription(numbered("k", i), payload(bytes(50'000, 'v'))), b.now));
  CHECK(b.counted().subscribers_octets <= 800'000);
  CHECK(b.counted().subscribers_octets > 600'000);
  CHECK(b.counted().subscribers_refused > 80);
  b.subscribe(robot, "x");
  CHECK(b.x.audience().has_subscriber(name_of("x")));
  b.take(b.x.on_message(port::unsubscribe, robot,
                        encode_unsubscribe(prototype_of(any_peer, name_of("x"))), b.now));
  b.take(b.x.on_host_vanished(hostile, b.now));
  CHECK(b.counted().subscribers_octets == 0);
}

TEST_CASE("all that others put into a space has one limit together", "[peis][TUP-08][TUP-24]") {
  tuple_space_config config;
  config.others_octets_max = 1'000'000;
  lone_space b(config);
  static_cast<void>(b.x.subscribe(prototype_of(any_peer, key()), subscription_id{1},
                                  tuple_space::interest::subscription, b.now));
  b.take(b.x.on_host_appeared(hostile, false, b.now));
  const auto octets = [&] {
    const auto all = b.counted();
    return all.held_octets + all.written_octets + all.subscribers_octets;
  };
  for (std::size_t i = 0; i < 20; ++i) {
    b.take(b.x.on_message(port::push, hostile,
                          message_of(tuple_of(hostile, numbered("t", i), 20'000)), b.now));
    b.set_by(hostile, numbered("w", i), 20'000);
    b.take(b.x.on_message(port::subscribe, hostile,
                          subscription(numbered("k", i), payload(bytes(6'000, 'v'))), b.now));
  }
  CHECK(octets() > 700'000);
  CHECK(octets() <= 800'000);
  CHECK(b.counted().subscribers_refused > 0);
  CHECK(b.counted().overflow > 0);
  b.subscribe(robot, "x"); // there is room for others, of each kind
  b.set_by(robot, "fan", 3);
  CHECK(b.x.audience().has_subscriber(name_of("x")));
  CHECK(b.x.stored().content(me, name_of("fan")) != nullptr);
}

TEST_CASE("one host may have 64 prototypes for one key", "[peis][TUP-08][TUP-20]") {
  lone_space b;
  const auto ask = [&](peer_id who, std::size_t i) {
    b.take(
        b.x.on_message(port::subscribe, who, subscription("k", payload(bytes(i + 1, 'v'))), b.now));
  };
  for (std::size_t i = 0; i < 64; ++i)
    ask(hostile, i);
  CHECK(b.counted().subscribers == 64);
  ask(hostile, 64);
  CHECK(b.counted().subscribers == 64);
  CHECK(b.counted().subscribers_refused == 1);
  ask(robot, 0);
  CHECK(b.counted().subscribers == 65);
}

TEST_CASE("what hosts that are away had subscribed to is kept within limits",
          "[peis][TUP-10][TUP-19]") {
  lone_space b;
  const auto come = [&](peer_id who, std::int32_t incarnation) {
    b.take(b.x.on_host_appeared(who, false, b.now, incarnation));
  };
  const auto go = [&](peer_id who) { b.take(b.x.on_host_vanished(who, b.now)); };
  come(hostile, 7);
  for (std::size_t i = 0; i < 300; ++i)
    b.subscribe(hostile, numbered("k", i));
  go(hostile);
  CHECK(b.counted().subscribers == 0);
  come(hostile, 7);
  CHECK(b.counted().subscribers == 256);
  go(hostile);
  come(hostile, 8); // another incarnation wants nothing yet
  CHECK(b.counted().subscribers == 0);
  for (std::size_t i = 0; i < 100; ++i)
    b.take(b.x.on_message(port::subscribe, hostile,
                          subscription(numbered("k", i), payload(bytes(10'000, 'v'))), b.now));
  go(hostile);
  come(hostile, 8);
  CHECK(b.counted().subscribers > 2);
  CHECK(b.counted().subscribers_octets <= std::size_t{1} << 18U);
  for (std::int32_t id = 1000; id < 1065; ++id) {
    come(peer_id{id}, 1);
    b.subscribe(peer_id{id}, "k");
    go(peer_id{id});
  }
  CHECK(b.counted().absent_forgotten == 1);
}

TEST_CASE("a key finds its subscriptions without looking at the others", "[peis][TUP-20]") {
  subscription_index<int> index;
  for (int i = 0; i < 20'000; ++i) {
    index.insert(name_of(numbered("a.*.k", static_cast<std::size_t>(i))), i);
    index.insert(name_of(numbered("*.b.k", static_cast<std::size_t>(i))), i);
  }
  index.insert(key(), -1);
  index.insert(name_of("*.*.*"), -2);
  index.insert(name_of("*.*"), -3);
  std::multiset<int> visited;
  index.for_matching(name_of("a.b.k77"), [&](int x) { visited.insert(x); });
  CHECK(visited == std::multiset<int>{-2, -1, 77, 77});
  CHECK(index.erase_if(name_of("a.*.k77"), [](int) { return true; }) == 1);
  CHECK(index.erase_if(name_of("a.*.k77"), [](int) { return true; }) == 0);
  CHECK(index.size() == 40'002);
  std::size_t below = 0;
  index.for_first_part("a", [&](int) { ++below; });
  CHECK(below == 19'999);
  std::size_t all = 0;
  index.for_all([&](int) { ++all; });
  CHECK(all == index.size());
}

TEST_CASE("tuples of another owner have a limit of octets and go with it", "[peis][TUP-19]") {
  tuple_space_config config;
  config.held_octets_max = 1'000'000;
  lone_space b(config);
  static_cast<void>(b.x.subscribe(prototype_of(any_peer, key()), subscription_id{1},
                                  tuple_space::interest::subscription, b.now));
  b.take(b.x.on_host_appeared(hostile, false, b.now));
  for (std::size_t i = 0; i < 150; ++i)
    b.take(b.x.on_message(port::push, hostile,
                          message_of(tuple_of(hostile, numbered("k", i), 100'000)), b.now));
  CHECK(b.counted().held_octets <= 800'000);
  CHECK(b.counted().held_octets > 650'000);
  CHECK(b.counted().overflow == 143);
  b.take(b.x.on_message(port::push, robot, message_of(tuple_of(robot, "t", 100)),
                        b.now)); // still room for others
  CHECK(b.x.stored().content(robot, name_of("t")) != nullptr);
  // What grows beyond the limit is reported as gone: its old value would be wrong.
  const auto grown =
      b.x.on_message(port::push, hostile, message_of(tuple_of(hostile, "k0", 900'000, 1)), b.now);
  REQUIRE(grown.size() == 1);
  CHECK(std::holds_alternative<tuple_deleted>(grown[0]));
  b.take(b.x.on_host_vanished(hostile, b.now));
  CHECK(b.counted().held_octets < 2'000);
}

TEST_CASE("own tuples that others write have a limit of octets", "[peis][TUP-05][TUP-24]") {
  tuple_space_config config;
  config.written_octets_max = 1'000'000;
  lone_space b(config);
  for (std::size_t i = 0; i < 150; ++i)
    b.set_by(hostile, numbered("k", i), 100'000);
  CHECK(b.counted().written_octets <= 800'000);
  CHECK(b.counted().written_octets > 650'000);
  CHECK(b.counted().overflow == 143);
  b.set_by(hostile, "k0", 90'000); // in the place of the old one
  CHECK(b.counted().overflow == 143);
  b.set_by(robot, "fan", 3);
  CHECK(b.x.stored().content(me, name_of("fan")) != nullptr);
  const auto before = b.counted().written_octets;
  b.set("k0", 500'000); // our own values are ours
  CHECK(b.counted().written_octets < before - 90'000);
  b.set("ours", 5'000'000);
  CHECK(b.x.stored().content(me, name_of("ours")) != nullptr);
}

TEST_CASE("what a writer leaves behind stays if it is little", "[peis][TUP-05][TUP-19]") {
  tuple_space_config config;
  config.orphaned_octets_max = 20'000;
  lone_space b(config);
  b.set("switch");
  b.take(b.x.on_host_appeared(hostile, false, b.now));
  b.take(b.x.on_host_appeared(robot, false, b.now));
  b.set_by(robot, "from-robot", 40'000);
  b.set_by(hostile, "switch", 30'000); // written, but created by us
  b.set_by(hostile, "task", 10);
  for (std::size_t i = 0; i < 10; ++i)
    b.set_by(hostile, numbered("k", i), 10'000);
  b.take(b.x.on_host_vanished(hostile, b.now));
  b.now += 29s;
  b.take(b.x.on_time(b.now));
  CHECK(b.counted().orphans_removed == 0);
  b.now += 1s;
  b.take(b.x.on_time(b.now));
  CHECK(b.counted().orphans_removed == 9);
  for (const auto* kept : {"switch", "task", "from-robot"})
    CHECK(b.x.stored().content(me, name_of(kept)) != nullptr);
  b.take(b.x.on_host_vanished(robot, b.now));
  b.now += 30s;
  b.take(b.x.on_time(b.now));
  CHECK(b.x.stored().content(me, name_of("from-robot")) == nullptr);
}

TEST_CASE("hosts that are unknown are few, and forgotten when they fall silent",
          "[peis][TUP-08][P2P-09]") {
  tuple_space_config config;
  config.strangers_max = 3;
  lone_space b(config);
  for (int i = 10; i < 13; ++i)
    b.subscribe(peer_id{i}, "x");
  CHECK(b.counted().subscribers == 3);
  b.subscribe(peer_id{13}, "x");
  CHECK(b.counted().subscribers == 3);
  CHECK(b.counted().strangers_refused == 1);
  b.take(b.x.on_host_appeared(peer_id{10}, false, b.now)); // its place is free
  b.subscribe(peer_id{13}, "x");
  CHECK(b.counted().subscribers == 4);
  b.now += 44s;
  b.take(b.x.on_time(b.now));
  CHECK(b.counted().subscribers == 4);
  b.now += 1s;
  b.take(b.x.on_time(b.now));
  CHECK(b.counted().subscribers == 1); // of the one that is known
}

TEST_CASE("a request of another appends to 256 tuples at most, or to none", "[peis][TUP-07]") {
  lone_space b;
  for (std::size_t i = 0; i < 256; ++i)
    b.set(numbered("a.k", i));
  b.take(b.x.on_message(port::append_request, hostile, append_request_for("a.*", 1), b.now));
  CHECK(b.counted().appends == 256);
  b.set("a.one-more");
  b.take(b.x.on_message(port::append_request, hostile, append_request_for("a.*", 1), b.now));
  CHECK(b.counted().appends == 256);
  CHECK(b.counted().appends_refused == 1);
}

TEST_CASE("others may not make a value longer than a mebibyte by appending", "[peis][TUP-07]") {
  lone_space b;
  b.set("log", (1U << 20U) - 10);
  b.take(b.x.on_message(port::append_request, hostile, append_request_for("log", 10), b.now));
  CHECK(b.x.stored().content(me, name_of("log"))->value.size() == 1U << 20U);
  b.take(b.x.on_message(port::append_request, hostile, append_request_for("log", 1), b.now));
  CHECK(b.x.stored().content(me, name_of("log"))->value.size() == 1U << 20U);
  CHECK(b.counted().appends_refused == 1);
  const auto own = b.x.append(prototype_of(me, name_of("log")), payload(bytes(10, 'z')), b.now);
  CHECK(own.first == cause::none);
}

} // namespace rubicon::peis
