#include "peis/space/held_tuples.hpp"

#include "unit/peis/tuples/tuple_parts.hpp"

namespace rubicon::peis {

using namespace test;

namespace {

/// Holds "log" of the other as "one".
struct lone_subscriber {
  tuple_parts p;
  tuple content;

  explicit lone_subscriber(bool marked = false) {
    static_cast<void>(p.hosts.appear(robot, marked, 0));
    static_cast<void>(p.local.add(prototype_of(any_peer, name_of("log")), subscription_id{1},
                                  local_subscriptions::interest::subscription));
    content.owner = content.creator = robot;
    content.name = name_of("log");
    content.written = {1000, 0};
    content.append_seqno = 77123; // garbage, as real kernels send
    value("one");
    CHECK(push().size() == 1);
  }
  void value(std::string_view text) { content.value = text_content(text).value; }
  tuple_events push(peer_id source = robot) {
    tuple_events out;
    p.held.on_push(source, message_of(content), start, out);
    return out;
  }
  tuple_events push(std::int32_t seqno, std::int32_t written, std::string_view text) {
    content.seqno = seqno;
    content.written = {written, 0};
    value(text);
    return push();
  }
  tuple_events push_deletion(std::int32_t seqno, std::int32_t written) {
    content.expiry = deleted;
    auto out = push(seqno, written, "");
    content.expiry = never;
    return out;
  }
  tuple_events notice(peer_id source, const payload& octets) {
    tuple_events out;
    p.held.on_append_notice(source, octets, start, out);
    return out;
  }
  tuple_events notice(std::string_view before, std::string_view added) {
    auto old = content;
    old.value = text_content(before).value;
    const auto tail = text_content(added).value;
    return notice(robot, joined(encode_append_notice_head(old, tail.size()), tail.view()));
  }
  tuple_events on_time(instant now) {
    tuple_events out;
    p.held.on_time(now, out);
    return out;
  }
  [[nodiscard]] std::string held() const {
    const auto x = p.stored(robot, "log");
    return x ? std::string(x->text()) : "none";
  }
  [[nodiscard]] const tuple_counters& counted() const { return p.held.counters(); }
};

} // namespace

TEST_CASE("an older value never replaces a newer one", "[peis][TUP-17]") {
  lone_subscriber s;
  static_cast<void>(s.push(5, 1000, "five"));
  static_cast<void>(s.push(4, 999, "four"));
  CHECK(s.held() == "five");
  static_cast<void>(s.push(5, 1000, "again"));
  CHECK(s.held() == "five");
  CHECK(s.counted().outdated == 2);
  static_cast<void>(s.push(0, 1001, "restarted")); // docs/peis-wire.md 15.3
  CHECK(s.held() == "restarted");
}

TEST_CASE("a late deletion does not remove a newer value", "[peis][TUP-16][TUP-17]") {
  lone_subscriber s;
  static_cast<void>(s.push(0, 1001, "created anew"));
  CHECK(s.push_deletion(9, 1000).empty());
  CHECK(s.held() == "created anew");
  const auto gone = s.push_deletion(1, 1002);
  REQUIRE(gone.size() == 1);
  CHECK(std::holds_alternative<tuple_deleted>(gone[0]));
  CHECK(s.held() == "none");
  CHECK(s.push_deletion(2, 1003).empty()); // of what is not held
  CHECK(s.counted().outdated == 2);
}

TEST_CASE("pushes without a subscription or in another's name are dropped", "[peis][TUP-08]") {
  lone_subscriber s;
  CHECK(s.push(hostile).empty());
  CHECK(s.counted().malformed == 1);
  s.content.name = name_of("x");
  CHECK(s.push().empty());
  CHECK(s.counted().unwanted == 1);
  static_cast<void>(
      s.p.local.add(prototype(), subscription_id{2}, local_subscriptions::interest::subscription));
  CHECK(s.push().size() == 1);
}

TEST_CASE("a value that finds no room ends the old one", "[peis][TUP-19]") {
  tuple_parts p({.held_octets_max = 10'000});
  p.subscribe_all();
  tuple_events out;
  p.held.on_push(robot, message_of(tuple_of(robot, "a", 100, 0)), p.now, out);
  p.held.on_push(robot, message_of(tuple_of(robot, "a", 20'000, 1)), p.now, out);
  REQUIRE(out.size() == 2);
  CHECK(std::holds_alternative<tuple_changed>(out[0]));
  CHECK(std::holds_alternative<tuple_deleted>(out[1]));
  CHECK(p.stored(robot, "a") == nullptr);
  CHECK(p.held.counters().overflow == 1);
}

TEST_CASE("values of an owner that has gone are removed, or kept as stale", "[peis][TUP-19]") {
  const bool keep = GENERATE(false, true);
  tuple_parts p({.keep_values_of_dead_hosts = keep});
  p.subscribe_all();
  tuple_events out;
  const auto octets = message_of(tuple_of(robot, "a", 100));
  p.held.on_push(robot, octets, p.now, out);
  p.held.on_owner_gone(robot, out);
  REQUIRE(out.size() == 2);
  const auto x = p.stored(robot, "a");
  REQUIRE((x != nullptr) == keep);
  if (!keep)
    return;
  CHECK(x->stale);
  p.held.on_push(robot, octets, p.now, out); // the same number and time: it is back
  CHECK(!p.stored(robot, "a")->stale);
}

TEST_CASE("what no other subscription wants goes with one, without notice", "[peis][TUP-09]") {
  lone_subscriber s;
  s.content.name = name_of("x");
  static_cast<void>(s.p.local.add(prototype_of(robot, key()), subscription_id{2},
                                  local_subscriptions::interest::subscription));
  CHECK(s.push().size() == 1);
  const auto gone = s.p.local.remove(subscription_id{2});
  REQUIRE(gone);
  s.p.held.on_unsubscribed(gone->wanted);
  CHECK(s.p.stored(robot, "x") == nullptr);
  CHECK(s.held() == "one");
}

TEST_CASE("notices that fit are applied, whatever number the append has", "[peis][TUP-07]") {
  lone_subscriber s(GENERATE(false, true));
  const auto changed = s.notice("one", " two");
  REQUIRE(changed.size() == 1);
  CHECK(std::get<tuple_changed>(changed[0]).content->text() == "one two");
  CHECK(s.notice("one two", " three").size() == 1);
  CHECK(s.held() == "one two three");
}

TEST_CASE("a notice that comes twice or after a newer set changes nothing", "[peis][TUP-07]") {
  lone_subscriber s;
  static_cast<void>(s.notice("one", " two"));
  CHECK(s.notice("one", " two").empty());
  CHECK(s.held() == "one two");
  const auto old = s.content;
  static_cast<void>(s.push(1, 1001, "new"));
  s.content = old;
  CHECK(s.notice("one two", " three").empty());
  CHECK(s.held() == "new");
  CHECK(s.counted().outdated == 2);
  CHECK(s.counted().append_gaps == 0);
}

TEST_CASE("a missing notice is made up for by a fresh value from the owner", "[peis][TUP-07]") {
  lone_subscriber s(GENERATE(false, true));
  const auto asked = s.notice("one two", " three"); // " two" was overtaken
  REQUIRE(asked.size() == 1);
  const auto& question = std::get<transmit>(asked[0]);
  CHECK(question.destination == robot);
  const auto message = decode_subscribe(question.content.head.view(), {});
  REQUIRE(message);
  CHECK(message->wanted == prototype_of(robot, name_of("log")));
  CHECK(s.held() == "one");
  s.value("one two"); // written before the last append: still incomplete
  CHECK(s.push().size() == 1);
  CHECK(s.p.held.deadline() == start + 2s);
  CHECK(s.on_time(start + 2s).size() == 1);
  s.value("one two three"); // same number and time: taken only because it was asked for
  CHECK(s.push().size() == 1);
  CHECK(s.held() == "one two three");
  CHECK(s.push().empty());
  for (int i = 4; i < 15; ++i)
    CHECK(s.on_time(start + i * 1s).empty()); // nothing to repair any more
}

TEST_CASE("repairs end after some attempts", "[peis][TUP-07]") {
  lone_subscriber s;
  CHECK(s.notice("one two", " three").size() == 1);
  std::size_t asked = 0;
  for (int i = 1; i < 60; ++i)
    asked += s.on_time(start + i * 1s).size();
  CHECK(asked == 4);
  CHECK(s.counted().append_gaps_given_up == 1);
  CHECK(!s.p.held.deadline());
}

TEST_CASE("notices without a subscription or in another's name are dropped", "[peis][TUP-07]") {
  lone_subscriber s;
  static_cast<void>(s.p.local.remove(subscription_id{1}));
  CHECK(s.notice("one", " two").empty());
  CHECK(s.counted().unwanted == 1);
  CHECK(s.notice(hostile, encode_append_notice_head(s.content, 0)).empty());
  CHECK(s.notice(robot, bytes(3)).empty());
  CHECK(s.counted().malformed == 2);
}

} // namespace rubicon::peis
