#include "peis/space/subscriber_feed.hpp"

#include "unit/peis/tuples/tuple_parts.hpp"

namespace rubicon::peis {

using namespace test;

namespace {

/// A feed, what it has sent, and a network that acknowledges when it is asked to.
struct lone_feed {
  tuple_parts p;
  std::vector<transmit> sent;

  explicit lone_feed(tuple_space_config config = {}) : p(config) {
    static_cast<void>(p.hosts.appear(robot, false, 0));
  }
  std::size_t take(tuple_events events) {
    for (auto& event : events)
      sent.push_back(std::get<transmit>(std::move(event)));
    return events.size();
  }
  std::size_t subscribe(peer_id who, std::string_view pattern,
                        std::optional<lifetime_tag> lifetime = {}) {
    tuple_events out;
    p.feed.subscribe(who, prototype_of(any_peer, name_of(pattern)), lifetime, p.now, out);
    return take(std::move(out));
  }
  std::size_t publish(const own_change& x) {
    tuple_events out;
    p.feed.publish(x, p.now, out);
    return take(std::move(out));
  }
  std::size_t set(std::string_view name, std::string_view text) {
    return publish(p.set(name, text));
  }
  std::size_t append(std::string_view name, std::string_view text) {
    const auto x = p.stored(me, name);
    return publish(*p.own.append(x, to_bytes(text), {}, p.feed.takes_notices(*x)).change);
  }
  std::size_t acknowledge() {
    tuple_events out;
    for (const auto& message : std::exchange(sent, {}))
      p.feed.on_delivered(message.request, p.now, out);
    return take(std::move(out));
  }
  void fail() {
    for (const auto& x : std::exchange(sent, {}))
      p.feed.on_undelivered(x.destination, x.port, x.content.head.view(), x.request, p.now);
  }
  std::size_t turn() {
    p.now = std::max(p.now, p.feed.deadline().value_or(p.now));
    tuple_events out;
    p.feed.refresh(p.now, out);
    p.feed.serve_pending(p.now, out);
    return take(std::move(out));
  }
};

} // namespace

TEST_CASE("a subscriber is sent what there is, and each change once", "[peis][TUP-08]") {
  lone_feed f;
  static_cast<void>(f.p.set("a.b", "1"));
  CHECK(f.subscribe(robot, "A.*") == 1);
  CHECK(f.subscribe(robot, "*.b") == 1);
  CHECK(f.set("a.b", "2") == 1);
  CHECK(f.set("c", "2") == 0);
  CHECK(f.p.feed.counters().pushes_sent == 3);
  CHECK(f.p.feed.counters().subscribers == 2);
  f.p.feed.unsubscribe(robot, any_peer, name_of("a.*"));
  CHECK(f.set("a.b", "3") == 1);
  f.p.feed.unsubscribe(robot, any_peer, name_of("*.b"));
  CHECK(f.set("a.b", "4") == 0);
}

TEST_CASE("who has no place as a stranger cannot subscribe", "[peis][TUP-08][P2P-09]") {
  lone_feed f({.strangers_max = 1});
  static_cast<void>(f.p.set("a", "1"));
  CHECK(f.subscribe(peer_id{10}, "a") == 1);
  CHECK(f.subscribe(peer_id{11}, "a") == 0);
  CHECK(f.p.feed.counters().subscribers == 1);
}

TEST_CASE("a subscriber to whom no route is known yet gets its values later", "[peis][TUP-18]") {
  lone_feed f;
  static_cast<void>(f.p.set("x", "1"));
  CHECK(f.subscribe(hostile, "x") == 1);
  f.fail();
  CHECK(f.p.feed.deadline() == f.p.now + 1s);
  CHECK(f.turn() == 1);
  CHECK(f.sent.at(0).destination == hostile);
  CHECK(f.sent.at(0).port == port::push);
  CHECK(f.p.feed.counters().pushes_retried == 1);
}

TEST_CASE("a value without room waits, and a newer one takes its place", "[peis][TUP-18]") {
  tuple_space_config config;
  config.pushes.messages_max = 1;
  lone_feed f(config);
  CHECK(f.subscribe(robot, "a") == 0);
  CHECK(f.set("a", "1") == 1);
  CHECK(!f.p.feed.is_waiting(name_of("a")));
  CHECK(f.set("a", "2") == 0);
  CHECK(f.set("a", "3") == 0);
  CHECK(f.p.feed.is_waiting(name_of("a")));
  CHECK(f.p.feed.counters().pushes_overtaken == 1);
  CHECK(f.acknowledge() == 1);
  CHECK(f.sent.at(0).content.body == text_content("3").value);
  CHECK(!f.p.feed.is_waiting(name_of("a")));
  CHECK(f.p.feed.counters().debtors == 0);
}

TEST_CASE("notices follow a whole value in order, one in flight", "[peis][TUP-07]") {
  lone_feed f;
  CHECK(f.subscribe(robot, "log") == 0);
  CHECK(f.set("log", "0") == 1);
  CHECK(f.acknowledge() == 0);
  CHECK(f.append("log", "1") == 1);
  CHECK(f.sent.at(0).port == port::push);
  CHECK(f.append("log", "2") == 0);
  CHECK(f.append("log", "3") == 0);
  CHECK(f.acknowledge() == 1);
  CHECK(f.sent.at(0).port == port::append_notice);
  CHECK(f.acknowledge() == 1);
  CHECK(f.acknowledge() == 0);
  CHECK(f.p.feed.counters().append_notices_sent == 2);
}

TEST_CASE("too many notices collapse into a value under a new number", "[peis][TUP-07]") {
  lone_feed f({.appends_waiting_max = 1});
  f.subscribe(robot, "log");
  f.set("log", "0");
  f.acknowledge();
  for (const auto* text : {"1", "2"})
    f.append("log", text);
  const auto seqno = f.p.stored(me, "log")->seqno;
  CHECK(f.append("log", "3") == 0);
  CHECK(f.p.feed.counters().appends_collapsed == 1);
  CHECK(f.p.stored(me, "log")->seqno == seqno + 1);
  f.sent.clear();
  CHECK(f.turn() == 1);
  CHECK(f.sent.at(0).port == port::push);
  CHECK(f.sent.at(0).content.body == text_content("0123").value);
}

TEST_CASE("a question goes to the hosts that it concerns, again if it fails", "[peis][TUP-11]") {
  lone_feed f;
  static_cast<void>(f.p.hosts.appear(hostile, true, 0));
  const auto ask = [&](peer_id owner, std::string_view pattern, std::uint64_t id) {
    tuple_events out;
    const auto added = f.p.local.add(prototype_of(owner, name_of(pattern)), subscription_id{id},
                                     local_subscriptions::interest::subscription);
    f.p.feed.ask(added.unasked, f.p.now, out);
    return f.take(std::move(out));
  };
  CHECK(ask(any_peer, "a", 1) == 2);
  CHECK(ask(any_peer, "a", 2) == 0);
  CHECK(ask(robot, "b", 3) == 1);
  CHECK(f.sent.back().destination == robot);
  f.fail();
  CHECK(f.turn() == 2); // one at a time to a host that has failed
  CHECK(f.acknowledge() == 1);
  CHECK(f.acknowledge() == 0);
  CHECK(f.p.feed.counters().debtors == 0);
  CHECK(f.turn() == 1); // the marked one: a refresh after a third of the lifetime
  CHECK(f.p.now == start + 20s);
  CHECK(f.sent.at(0).destination == hostile);
}

TEST_CASE("a subscription with a lifetime ends if it is not repeated", "[peis][TUP-10]") {
  lone_feed f;
  static_cast<void>(f.p.set("a", "1"));
  CHECK(f.subscribe(robot, "a", lifetime_tag{true, 60}) == 1);
  f.p.now += 20s;
  CHECK(f.subscribe(robot, "a", lifetime_tag{true, 60}) == 0);
  f.acknowledge();
  while (f.p.feed.deadline())
    f.turn();
  CHECK(f.p.feed.counters().subscribers == 0);
  CHECK(f.p.now >= start + 80s);
}

TEST_CASE("nothing is left of a host that has gone", "[peis][TUP-19]") {
  lone_feed f;
  static_cast<void>(f.p.set("a", "1"));
  f.subscribe(robot, "a");
  f.set("a", "2");
  f.fail();
  f.p.feed.on_host_gone(robot);
  const auto counted = f.p.feed.counters();
  CHECK(counted.debtors == 0);
  CHECK(counted.subscribers == 0);
  CHECK(counted.pushes_octets == 0);
  CHECK(f.turn() == 0);
  CHECK(!f.p.feed.deadline());
}

} // namespace rubicon::peis
