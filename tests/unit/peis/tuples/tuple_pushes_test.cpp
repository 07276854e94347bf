// What a tuple space does for others at once, and whose turn it is. Work is counted in steps and
// messages, not in time.
#include "unit/peis/tuples/lone_space.hpp"

namespace rubicon::peis {

using namespace test;

namespace {

std::size_t steps_for(std::size_t tuples) {
  lone_space b;
  b.fill(tuples);
  b.subscribe(robot, "a.*");
  b.work_off();
  CHECK(b.sent_so_far == tuples);
  return b.counted().steps;
}

} // namespace

TEST_CASE("what many tuples match is sent in pieces, each once", "[peis][TUP-08][TUP-20]") {
  lone_space b;
  b.fill(10'000);
  CHECK(b.subscribe(robot, "a.*") <= 64);
  std::size_t most = 0;
  for (int i = 0; i < 1000; ++i)
    most = std::max(most, b.turn());
  CHECK(most <= 512);
  CHECK(b.sent_so_far == 2048); // nothing is acknowledged: no more may be in flight
  b.acknowledge();
  b.work_off();
  CHECK(b.sent_so_far == 10'000);
  CHECK(b.counted().debtors == 0);
  CHECK(b.counted().pushes_octets == 0);
}

TEST_CASE("the work for a subscription grows with the tuples that it may match",
          "[peis][TUP-20][NFR-09]") {
  const auto few = steps_for(2'000);
  const auto many = steps_for(20'000);
  CHECK(few <= 2'000 * 10);
  CHECK(many <= few * 11);
  lone_space b;
  b.fill(20'000);
  b.subscribe(robot, "b.*"); // no tuple begins so
  b.subscribe(robot, "a.k77");
  CHECK(b.counted().steps < 100);
  CHECK(b.sent_so_far == 1);
}

TEST_CASE("equal subscriptions cost no more than two", "[peis][TUP-08][NFR-09]") {
  lone_space b;
  b.fill(10'000);
  std::size_t at_once = 0;
  for (int i = 0; i < 300; ++i)
    at_once += b.subscribe(hostile, "a.*");
  CHECK(at_once <= 64);
  CHECK(b.counted().subscribers == 1);
  b.work_off();
  CHECK(b.sent_so_far ==
        20'000); // a real kernel's repeat is answered, if not more often than it can take
}

TEST_CASE("who takes nothing does not delay others", "[peis][TUP-18]") {
  lone_space b;
  b.fill(20'000);
  b.subscribe(hostile, "a.*");
  for (int i = 0; i < 100; ++i)
    b.turn();
  const auto held_back = b.sent_so_far;
  CHECK(b.subscribe(robot, "a.k5") == 1);
  b.take(b.x.set(name_of("a.k5"), text_content("new"), b.now).second);
  REQUIRE(b.sent_so_far == held_back + 2);
  CHECK(b.sent.back().destination == robot);
  CHECK(b.counted().pushes_deferred == 1);
}

/// Who subscribes in the name of hosts that cannot be reached makes many debtors, which fail
/// again and again.
TEST_CASE("debtors that cannot be reached cost their own tries only", "[peis][TUP-18][P2P-09]") {
  lone_space b;
  const auto ghosts = tuple_space_config().strangers_max;
  for (std::size_t i = 0; i < ghosts; ++i)
    b.subscribe(peer_id{1000 + static_cast<int>(i)}, "a");
  b.set("a");
  b.fail_all();
  REQUIRE(b.counted().debtors == ghosts);
  const auto sent_so_far = b.sent_so_far;
  static_cast<void>(b.x.take_work());
  for (std::size_t i = 0; i < 50; ++i)
    b.set("a", i + 2);
  CHECK(b.sent_so_far == sent_so_far); // they are tried again in their time
  CHECK(b.x.take_work() >= 50 * ghosts / 8);
  b.now += 900ms;
  CHECK(b.x.deadline() > b.now);
  b.now += 100ms;
  for (int i = 0; i < 20; ++i)
    b.turn();
  CHECK(b.sent_so_far == sent_so_far + ghosts); // of the newest value, once each
  CHECK(b.sent.back().content.size() > 51);
}

TEST_CASE("a stranger that becomes known is sent at once what it has missed", "[peis][TUP-18]") {
  lone_space b;
  const peer_id late{1000};
  b.subscribe(late, "a");
  b.set("a");
  b.fail_all();
  b.sent.clear();
  b.take(b.x.on_host_appeared(late, false, b.now));
  b.turn();
  REQUIRE(b.sent.size() == 1);
  CHECK(b.sent.front().destination == late);
}

TEST_CASE("two that ask for all tuples are served in turns", "[peis][TUP-18][TUP-20]") {
  lone_space b;
  b.fill(20'000);
  b.subscribe(hostile, "a.*");
  b.subscribe(robot, "a.*");
  std::size_t to_robot = 0;
  std::size_t to_hostile = 0;
  for (int i = 0; i < 4; ++i) {
    b.sent.clear();
    b.turn();
    for (const auto& x : b.sent)
      ++(x.destination == robot ? to_robot : to_hostile);
  }
  CHECK(to_robot >= to_hostile / 2);
  CHECK(to_robot > 100);
}

TEST_CASE("of values that found no room only the newest is sent, deletions too",
          "[peis][TUP-16][TUP-18]") {
  tuple_space_config config;
  config.pushes.messages_max = 4;
  lone_space b(config);
  for (const auto* name : {"a", "b", "c", "d", "e", "f"})
    b.set(name);
  b.subscribe(robot, "");
  CHECK(b.sent_so_far == 4);
  for (std::size_t i = 0; i < 50; ++i) {
    b.set("a", i + 2);
    b.turn();
  }
  b.take(b.x.remove(name_of("b"), b.now));
  CHECK(b.sent_so_far == 4);
  for (int i = 0; i < 20; ++i) {
    auto before = b.sent;
    b.acknowledge();
    b.turn();
  }
  CHECK(b.sent_so_far >= 8);
  CHECK(b.sent_so_far <= 10);
  CHECK(b.counted().debtors == 0);
}

TEST_CASE("each value that a newer one overtakes is counted, and a writer can wait instead",
          "[peis][TUP-18]") {
  tuple_space_config config;
  config.pushes.messages_max = 4;
  const bool waits = GENERATE(false, true);
  lone_space b(config);
  b.subscribe(robot, "a");
  for (std::size_t i = 0; i < 100; ++i) {
    while (waits && b.x.is_waiting(name_of("a"))) {
      b.acknowledge();
      b.turn();
    }
    b.set("a", i + 1);
    CHECK(!b.x.is_waiting(name_of("b")));
  }
  CHECK(b.x.is_waiting(name_of("a")) == !waits);
  b.work_off();
  CHECK(!b.x.is_waiting(name_of("a")));
  CHECK(b.sent_so_far + b.counted().pushes_overtaken == 100);
  CHECK(b.sent_so_far == (waits ? 100 : 5));
}

TEST_CASE("a deletion that found no room is sent later", "[peis][TUP-16]") {
  tuple_space_config config;
  config.pushes.messages_max = 1;
  lone_space b(config);
  b.subscribe(robot, "b");
  b.set("b");
  b.take(b.x.remove(name_of("b"), b.now));
  REQUIRE(b.sent.size() == 1);
  b.acknowledge();
  REQUIRE(b.sent.size() == 1);
  const auto& last = b.sent[0].content;
  const auto x = decode_tuple_message(joined(to_bytes(last.head.view()), last.body.view()), {});
  REQUIRE(x);
  CHECK(x->expiry == deleted);
  CHECK(x->name == name_of("b"));
}

TEST_CASE("a host that fails gets one message at a time until it takes it", "[peis][TUP-18]") {
  lone_space b;
  b.fill(100);
  b.subscribe(robot, "a.*");
  b.turn();
  CHECK(b.sent.size() == 100);
  b.fail(robot);
  CHECK(b.x.deadline() == b.now + 1s);
  b.turn();
  CHECK(b.sent.size() == 1);
  b.acknowledge();
  CHECK(b.sent.size() == 2);
  b.acknowledge();
  b.work_off();
  CHECK(b.counted().debtors == 0);
  CHECK(b.sent_so_far == 200);
}

TEST_CASE("who misses too many values is looked through again", "[peis][TUP-18]") {
  tuple_space_config config;
  config.pushes.messages_max = 1;
  config.missed_max = 10;
  lone_space b(config);
  b.subscribe(robot, "a.*");
  b.fill(11);
  CHECK(b.sent_so_far == 1);
  CHECK(b.counted().resyncs == 0);
  b.set("a.k11");
  CHECK(b.counted().resyncs == 1);
  b.work_off();
  for (int i = 0; i < 100; ++i)
    b.acknowledge();
  CHECK(b.sent_so_far >= 12);
  CHECK(b.sent_so_far <= 14);
  CHECK(b.counted().debtors == 0);
}

TEST_CASE("pushes in flight have a limit of octets, for one host and for all", "[peis][TUP-18]") {
  tuple_space_config config;
  config.pushes.octets_max = 10'000;
  config.pushes.total_max = 25'000;
  config.pushes.small = 1'000;
  lone_space b(config);
  for (int host = 2; host < 10; ++host)
    b.subscribe(peer_id{host}, "*");
  for (std::size_t i = 0; i < 10; ++i)
    b.set(numbered("k", i), 4'000);
  CHECK(b.counted().pushes_octets <= 25'000);
  CHECK(b.counted().pushes_octets > 20'000);
  b.subscribe(peer_id{20}, "small");
  b.set("small", 10); // the only one to its host: no flood of others holds it up
  CHECK(b.sent.back().destination == peer_id{20});
  b.work_off();
  CHECK(b.counted().pushes_octets == 0);
  CHECK(b.sent_so_far == 90); // 8 times 11, and "small" as a change and as what is there already
}

TEST_CASE("appends that wait have a limit of octets", "[peis][TUP-07]") {
  tuple_space_config config;
  config.appends_waiting_octets_max = 10'000;
  lone_space b(config);
  b.subscribe(robot, "log");
  b.set("log", 10);
  for (int i = 0; i < 40; ++i)
    b.take(b.x.append(prototype_of(me, name_of("log")), payload(bytes(1'000, 'z')), b.now).second);
  CHECK(b.counted().appends_collapsed > 0);
  b.work_off();
  b.now += 1s;
  b.turn();
  b.acknowledge();
  CHECK(b.counted().debtors == 0);
}

TEST_CASE("a host is asked everything, however much it is, and once", "[peis][TUP-08][TUP-11]") {
  lone_space b;
  for (int host = 2; host < 10; ++host)
    b.take(b.x.on_host_vanished(peer_id{host}, b.now));
  constexpr std::size_t count = 20'000;
  for (std::size_t i = 0; i < count; ++i)
    static_cast<void>(b.x.subscribe(prototype_of(any_peer, name_of(numbered("k", i))),
                                    subscription_id{i + 1}, tuple_space::interest::subscription,
                                    b.now));
  const auto equal =
      b.x.subscribe(prototype_of(any_peer, name_of("k0")), subscription_id{count + 1},
                    tuple_space::interest::subscription, b.now);
  CHECK(equal.first == cause::none);
  CHECK(b.take(b.x.on_host_appeared(robot, false, b.now)) <= 64);
  for (int i = 0; i < 100; ++i)
    b.turn();
  CHECK(b.sent_so_far == 2048);
  b.fail(robot); // all of them
  b.turn();      // a second later
  b.work_off();
  CHECK(b.counted().debtors == 0);
  CHECK(b.sent_so_far == count + 2048);
  CHECK(b.counted().steps < 12 * (count + 2048));
}

} // namespace rubicon::peis
