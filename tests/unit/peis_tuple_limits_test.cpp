// What others can make a tuple space hold and do: limits, one beyond them, and whose turn it is.
// Work is counted in steps and messages, not in time.
#include <set>
#include <string>
#include <vector>

#include "peis/package.hpp"
#include "peis/tuple_space.hpp"
#include "support/catch.hpp"

namespace rubicon::peis {
namespace {

constexpr peer_id me{1};
constexpr peer_id robot{2};
constexpr peer_id hostile{3};
constexpr instant start{100s};
constexpr duration offset = 1'000'000'000s;

key name_of(std::string_view text) {
  return *key::parse(text);
}

std::string numbered(std::string_view prefix, std::size_t i) {
  return std::string(prefix) + std::to_string(i);
}

bytes joined(bytes head, byte_view body) {
  head.insert(head.end(), body.begin(), body.end());
  return head;
}

bytes subscription(std::string_view pattern, std::optional<payload> value = {}) {
  subscribe_message message;
  message.wanted.name = name_of(pattern);
  message.wanted.value = std::move(value);
  return encode(message);
}

tuple tuple_of(peer_id owner, std::string_view name, std::size_t size, std::int32_t seqno = 0) {
  tuple x;
  x.owner = x.creator = owner;
  x.name = name_of(name);
  x.form = encoding::binary;
  x.value = payload(bytes(size, 'x'));
  x.written = {1000 + seqno, 0};
  x.seqno = seqno;
  return x;
}

bytes message_of(const tuple& x) {
  return joined(encode_tuple_head(x, tuple_message_kind::push), x.value.view());
}

bytes append_request_for(std::string_view pattern, std::size_t size) {
  append_request x{prototype_of(me, name_of(pattern)), payload(bytes(size, 'y'))};
  return joined(encode_append_request_head(x), x.added.view());
}

/// A tuple space, what it has sent, and a network that acknowledges when it is told to.
struct bench {
  tuple_space x;
  instant now = start;
  std::vector<transmit> sent; ///< and not acknowledged yet
  std::size_t told = 0;       ///< all that was ever sent

  explicit bench(tuple_space_config config = {}) : x(config, me, offset) {}

  std::size_t take(tuple_events events) {
    std::size_t count = 0;
    for (auto& event : events) {
      if (auto* message = std::get_if<transmit>(&event)) {
        sent.push_back(std::move(*message));
        ++count;
      }
    }
    told += count;
    return count;
  }
  void set(std::string_view name, std::size_t size = 1) {
    take(x.set(name_of(name), binary_content(bytes(size, 'v')), now).second);
  }
  void fill(std::size_t count) {
    for (std::size_t i = 0; i < count; ++i)
      set(numbered("a.k", i));
  }
  std::size_t subscribe(peer_id who, std::string_view pattern) {
    return take(x.on_subscribe(who, subscription(pattern), now));
  }
  /// What is due at the next deadline.
  std::size_t turn() {
    now = std::max(now, x.deadline().value_or(now));
    return take(x.on_time(now));
  }
  void acknowledge(std::optional<peer_id> only = {}) {
    for (const auto& message : std::exchange(sent, {})) {
      if (only && message.destination != *only)
        sent.push_back(message);
      else
        take(x.on_delivered(message.request, now));
    }
  }
  void fail(peer_id whose) {
    for (const auto& message : std::exchange(sent, {})) {
      if (message.destination != whose)
        sent.push_back(message);
      else
        x.on_undelivered(whose, message.port, message.content.head.view(), message.request, now);
    }
  }
  std::size_t set_by(peer_id who, std::string_view name, std::size_t size) {
    return take(x.on_set(who, tuple_of(me, name, size), true, now));
  }
  /// Until nothing is due within a second, at most so many turns.
  void work_off(int turns = 10'000) {
    for (; turns > 0 && x.deadline() && *x.deadline() < now + 900ms; --turns) {
      turn();
      acknowledge();
    }
    CHECK(turns > 0);
  }
  [[nodiscard]] tuple_counters counted() const { return x.counters(); }
};

std::size_t steps_for(std::size_t tuples) {
  bench b;
  b.fill(tuples);
  b.subscribe(robot, "a.*");
  b.work_off();
  CHECK(b.told == tuples);
  return b.counted().steps;
}

} // namespace

TEST_CASE("what many tuples match is sent in pieces, each once", "[peis][TUP-08][TUP-20]") {
  bench b;
  b.fill(10'000);
  CHECK(b.subscribe(robot, "a.*") <= 64);
  std::size_t most = 0;
  for (int i = 0; i < 1000; ++i)
    most = std::max(most, b.turn());
  CHECK(most <= 512);
  CHECK(b.told == 2048); // nothing is acknowledged: no more may be under way
  b.acknowledge();
  b.work_off();
  std::set<std::string> names;
  CHECK(b.told == 10'000);
  CHECK(b.counted().debtors == 0);
  CHECK(b.counted().pushes_octets == 0);
}

TEST_CASE("the work for a subscription grows with the tuples that it may match",
          "[peis][TUP-20][NFR-09]") {
  const auto few = steps_for(2'000);
  const auto many = steps_for(20'000);
  CHECK(few <= 2'000 * 10);
  CHECK(many <= few * 11);
  bench b;
  b.fill(20'000);
  b.subscribe(robot, "b.*"); // no tuple begins so
  b.subscribe(robot, "a.k77");
  CHECK(b.counted().steps < 100);
  CHECK(b.told == 1);
}

TEST_CASE("equal subscriptions cost no more than two", "[peis][TUP-08][NFR-09]") {
  bench b;
  b.fill(10'000);
  std::size_t at_once = 0;
  for (int i = 0; i < 300; ++i)
    at_once += b.subscribe(hostile, "a.*");
  CHECK(at_once <= 64);
  CHECK(b.counted().subscribers == 1);
  b.work_off();
  CHECK(b.told == 20'000); // a real kernel's repeat is answered, if not more often than it can take
}

TEST_CASE("who takes nothing does not delay others", "[peis][TUP-18]") {
  bench b;
  b.fill(20'000);
  b.subscribe(hostile, "a.*");
  for (int i = 0; i < 100; ++i)
    b.turn();
  const auto held_back = b.told;
  CHECK(b.subscribe(robot, "a.k5") == 1);
  b.take(b.x.set(name_of("a.k5"), text_content("new"), b.now).second);
  REQUIRE(b.told == held_back + 2);
  CHECK(b.sent.back().destination == robot);
  CHECK(b.counted().pushes_deferred == 1);
}

TEST_CASE("two that ask for all tuples are served in turns", "[peis][TUP-18][TUP-20]") {
  bench b;
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
  bench b(config);
  for (const auto* name : {"a", "b", "c", "d", "e", "f"})
    b.set(name);
  b.subscribe(robot, "");
  CHECK(b.told == 4);
  for (std::size_t i = 0; i < 50; ++i) {
    b.set("a", i + 2);
    b.turn();
  }
  b.take(b.x.remove(name_of("b"), b.now));
  CHECK(b.told == 4);
  for (int i = 0; i < 20; ++i) {
    auto before = b.sent;
    b.acknowledge();
    b.turn();
  }
  CHECK(b.told >= 8);
  CHECK(b.told <= 10);
  CHECK(b.counted().debtors == 0);
}

TEST_CASE("a deletion that found no room is told later", "[peis][TUP-16]") {
  tuple_space_config config;
  config.pushes.messages_max = 1;
  bench b(config);
  b.subscribe(robot, "b");
  b.set("b");
  b.take(b.x.remove(name_of("b"), b.now));
  REQUIRE(b.sent.size() == 1);
  b.acknowledge();
  REQUIRE(b.sent.size() == 1);
  const auto& last = b.sent[0].content;
  const auto x = decode_tuple_message(joined(to_bytes(last.head.view()), last.body.view()));
  REQUIRE(x);
  CHECK(x->expiry == deleted);
  CHECK(x->name == name_of("b"));
}

TEST_CASE("a host that fails gets one message at a time until it takes it", "[peis][TUP-18]") {
  bench b;
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
  CHECK(b.told == 200);
}

TEST_CASE("who misses too many values is looked through again", "[peis][TUP-18]") {
  tuple_space_config config;
  config.pushes.messages_max = 1;
  config.missed_max = 10;
  bench b(config);
  b.subscribe(robot, "a.*");
  b.fill(11);
  CHECK(b.told == 1);
  CHECK(b.counted().resyncs == 0);
  b.set("a.k11");
  CHECK(b.counted().resyncs == 1);
  b.work_off();
  for (int i = 0; i < 100; ++i)
    b.acknowledge();
  CHECK(b.told >= 12);
  CHECK(b.told <= 14);
  CHECK(b.counted().debtors == 0);
}

TEST_CASE("pushes under way have a limit of octets, for one host and for all", "[peis][TUP-18]") {
  tuple_space_config config;
  config.pushes.octets_max = 10'000;
  config.pushes.total_max = 25'000;
  config.pushes.small = 1'000;
  bench b(config);
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
  CHECK(b.told == 81);
}

TEST_CASE("records of subscribers have a limit that hosts share", "[peis][TUP-08][TUP-24]") {
  tuple_space_config config;
  config.subscribers_max = 10;
  bench b(config);
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
  bench b(config);
  for (std::size_t i = 0; i < 100; ++i)
    b.take(b.x.on_subscribe(hostile, subscription(numbered("k", i), payload(bytes(50'000, 'v'))),
                            b.now));
  CHECK(b.counted().subscribers_octets <= 800'000);
  CHECK(b.counted().subscribers_octets > 600'000);
  CHECK(b.counted().subscribers_refused > 80);
  b.subscribe(robot, "x");
  CHECK(b.x.has_subscriber(name_of("x")));
  b.take(b.x.on_unsubscribe(robot, encode_unsubscribe(prototype_of(any_peer, name_of("x")))));
  b.take(b.x.on_host_vanished(hostile, b.now));
  CHECK(b.counted().subscribers_octets == 0);
}

TEST_CASE("one host may have 64 prototypes for one key", "[peis][TUP-08][TUP-20]") {
  bench b;
  const auto ask = [&](peer_id who, std::size_t i) {
    b.take(b.x.on_subscribe(who, subscription("k", payload(bytes(i + 1, 'v'))), b.now));
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
  bench b(config);
  static_cast<void>(b.x.subscribe(prototype_of(any_peer, key()), subscription_id{1},
                                  tuple_space::interest::subscription, b.now));
  b.take(b.x.on_host_appeared(hostile, false, b.now));
  for (std::size_t i = 0; i < 150; ++i)
    b.take(b.x.on_push(hostile, message_of(tuple_of(hostile, numbered("k", i), 100'000)), b.now));
  CHECK(b.counted().held_octets <= 800'000);
  CHECK(b.counted().held_octets > 650'000);
  CHECK(b.counted().overflow == 143);
  b.take(b.x.on_push(robot, message_of(tuple_of(robot, "t", 100)), b.now)); // still room for others
  CHECK(b.x.find(robot, name_of("t")) != nullptr);
  // What grows beyond the limit is told as gone: its old value would be wrong.
  const auto grown = b.x.on_push(hostile, message_of(tuple_of(hostile, "k0", 900'000, 1)), b.now);
  REQUIRE(grown.size() == 1);
  CHECK(std::holds_alternative<tuple_deleted>(grown[0]));
  b.take(b.x.on_host_vanished(hostile, b.now));
  CHECK(b.counted().held_octets < 2'000);
}

TEST_CASE("own tuples that others write have a limit of octets", "[peis][TUP-05][TUP-24]") {
  tuple_space_config config;
  config.written_octets_max = 1'000'000;
  bench b(config);
  for (std::size_t i = 0; i < 150; ++i)
    b.set_by(hostile, numbered("k", i), 100'000);
  CHECK(b.counted().written_octets <= 800'000);
  CHECK(b.counted().written_octets > 650'000);
  CHECK(b.counted().overflow == 143);
  b.set_by(hostile, "k0", 90'000); // in the place of the old one
  CHECK(b.counted().overflow == 143);
  b.set_by(robot, "fan", 3);
  CHECK(b.x.find(me, name_of("fan")) != nullptr);
  const auto before = b.counted().written_octets;
  b.set("k0", 500'000); // our own values are ours
  CHECK(b.counted().written_octets < before - 90'000);
  b.set("ours", 5'000'000);
  CHECK(b.x.find(me, name_of("ours")) != nullptr);
}

TEST_CASE("what a writer leaves behind stays if it is little", "[peis][TUP-05][TUP-19]") {
  tuple_space_config config;
  config.orphaned_octets_max = 20'000;
  bench b(config);
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
    CHECK(b.x.find(me, name_of(kept)) != nullptr);
  b.take(b.x.on_host_vanished(robot, b.now));
  b.now += 30s;
  b.take(b.x.on_time(b.now));
  CHECK(b.x.find(me, name_of("from-robot")) == nullptr);
}

TEST_CASE("hosts that nobody knows are few, and forgotten when they fall silent",
          "[peis][TUP-08][P2P-09]") {
  tuple_space_config config;
  config.strangers_max = 3;
  bench b(config);
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
  bench b;
  for (std::size_t i = 0; i < 256; ++i)
    b.set(numbered("a.k", i));
  b.take(b.x.on_append_request(hostile, append_request_for("a.*", 1), b.now));
  CHECK(b.counted().appends == 256);
  b.set("a.one-more");
  b.take(b.x.on_append_request(hostile, append_request_for("a.*", 1), b.now));
  CHECK(b.counted().appends == 256);
  CHECK(b.counted().appends_refused == 1);
}

TEST_CASE("others may not make a value longer than a mebibyte by appending", "[peis][TUP-07]") {
  bench b;
  b.set("log", (1U << 20U) - 10);
  b.take(b.x.on_append_request(hostile, append_request_for("log", 10), b.now));
  CHECK(b.x.find(me, name_of("log"))->value.size() == 1U << 20U);
  b.take(b.x.on_append_request(hostile, append_request_for("log", 1), b.now));
  CHECK(b.x.find(me, name_of("log"))->value.size() == 1U << 20U);
  CHECK(b.counted().appends_refused == 1);
  const auto own = b.x.append(prototype_of(me, name_of("log")), payload(bytes(10, 'z')), b.now);
  CHECK(own.first == cause::none);
}

TEST_CASE("appends that wait have a limit of octets", "[peis][TUP-07]") {
  tuple_space_config config;
  config.appends_waiting_octets_max = 10'000;
  bench b(config);
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
  bench b;
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
  CHECK(b.told == 2048);
  b.fail(robot); // all of them
  for (int i = 0; i < 200 && b.counted().debtors > 0; ++i) {
    b.turn();
    b.acknowledge();
  }
  CHECK(b.counted().debtors == 0);
  CHECK(b.told == count + 2048);
  CHECK(b.counted().steps < 12 * (count + 2048));
}

} // namespace rubicon::peis
