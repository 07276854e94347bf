#include "peis/space/own_tuples.hpp"

#include "unit/peis/tuples/tuple_parts.hpp"

namespace rubicon::peis {

using namespace test;

TEST_CASE("a full tuple space refuses new tuples, not new values", "[peis][TUP-24]") {
  tuple_parts p({.tuples_max = 2});
  const auto set = [&](std::string_view name) {
    return p.own.set(name_of(name), text_content("1"), p.now).why;
  };
  CHECK(set("a") == cause::none);
  CHECK(set("b") == cause::none);
  CHECK(set("c") == cause::space_full);
  CHECK(set("b") == cause::none);
  CHECK(p.own.counters().refused == 1);
  CHECK(p.own.counters().sets == 3);
}

TEST_CASE("no number of a key comes twice, also after a deletion", "[peis][TUP-16][TUP-17]") {
  tuple_parts p;
  static_cast<void>(p.set("a", "1"));
  static_cast<void>(p.set("a", "2"));
  CHECK(p.stored(me, "a")->seqno == 1);
  const auto gone = p.own.remove(name_of("a"), p.now);
  REQUIRE(gone);
  const auto& x = std::get<own_value_deleted>(*gone);
  CHECK(x.gone->text() == "2");
  CHECK(x.last.seqno == 2);
  CHECK(x.last.expiry == deleted);
  CHECK(p.own.deletion_of(name_of("a"), p.now).seqno == 2);
  CHECK(!p.own.remove(name_of("a"), p.now));
  static_cast<void>(p.set("a", "3"));
  CHECK(p.stored(me, "a")->seqno == 3);
}

TEST_CASE("the set of own keys has a version", "[peis][TUP-22]") {
  tuple_parts p;
  static_cast<void>(p.set("a", "1"));
  const auto version = p.own.keys_version();
  static_cast<void>(p.set("a", "2"));
  CHECK(p.own.keys_version() == version);
  static_cast<void>(p.own.remove(name_of("a"), p.now));
  CHECK(p.own.keys_version() == version + 1);
}

TEST_CASE("others write what they may, in our time", "[peis][TUP-05][TUP-22]") {
  tuple_parts p;
  const auto x = tuple_of(me, "a", 3);
  CHECK(!p.own.on_set(robot, x, false, p.now));
  CHECK(p.own.counters().refused == 1);
  REQUIRE(p.own.on_set(robot, x, true, p.now));
  CHECK(p.stored(me, "a")->written == p.clock.network_time(p.now));
  CHECK(p.store.find(me, name_of("a"))->by ==
        tuple_store::source{tuple_store::origin::written, robot});
  CHECK(!p.own.decode_set(bytes(3), p.now));
  CHECK(!p.own.decode_set(message_of(tuple_of(hostile, "a", 1)), p.now)); // not ours
  CHECK(p.own.counters().malformed == 2);
}

TEST_CASE("who has no place as a stranger cannot write", "[peis][TUP-05][P2P-09]") {
  tuple_parts p({.strangers_max = 0});
  CHECK(!p.own.on_set(hostile, tuple_of(me, "a", 3), true, p.now));
  CHECK(p.stored(me, "a") == nullptr);
  static_cast<void>(p.hosts.appear(hostile, false, 0));
  CHECK(p.own.on_set(hostile, tuple_of(me, "a", 3), true, p.now));
}

TEST_CASE("an append is sent alone if subscribers can take it", "[peis][TUP-07]") {
  tuple_parts p;
  static_cast<void>(p.set("a", "one"));
  const auto whole = p.own.append(p.stored(me, "a"), to_bytes(" two"), {}, false);
  REQUIRE(whole.change);
  CHECK(std::get<own_value_extended>(*whole.change).content->seqno == 1);
  const auto before = p.stored(me, "a");
  const auto more = p.own.append(before, to_bytes("!"), robot, true);
  REQUIRE(more.change);
  const auto& x = std::get<own_value_appended>(*more.change);
  CHECK(x.before == before);
  CHECK(x.content->text() == "one two!");
  CHECK(x.content->seqno == 1);
  CHECK(x.content->append_seqno == 1);
  CHECK(x.added == payload(bytes{'!', 0}));
}

TEST_CASE("text without its NUL is sent whole when it grows", "[peis][TUP-07]") {
  tuple_parts p;
  tuple_content content;
  content.value = payload(to_bytes("ab"));
  static_cast<void>(p.own.set(name_of("a"), content, p.now));
  const auto grown = p.own.append(p.stored(me, "a"), to_bytes("c"), {}, true);
  REQUIRE(grown.change);
  CHECK(std::get<own_value_extended>(*grown.change).content->text() == "abc");
}

TEST_CASE("a new number of the same value is not news", "[peis][TUP-07][TUP-12]") {
  tuple_parts p;
  static_cast<void>(p.set("a", "1"));
  p.store.read(prototype(), p.now, [](const auto&, bool) { return true; });
  p.own.renumber(name_of("a"));
  p.own.renumber(name_of("b")); // there is none
  CHECK(p.stored(me, "a")->seqno == 1);
  CHECK(!p.own.find(name_of("a"))->is_new);
}

TEST_CASE("orphans are due once, the largest first, after their writer has gone",
          "[peis][TUP-05][TUP-19]") {
  tuple_parts p({.orphaned_octets_max = 20'000});
  static_cast<void>(p.own.on_set(hostile, tuple_of(me, "small", 10), true, p.now));
  static_cast<void>(p.own.on_set(hostile, tuple_of(me, "large", 40'000), true, p.now));
  p.own.on_writer_gone(robot, p.now); // has written nothing
  CHECK(!p.own.deadline());
  p.hosts.vanish(hostile, {});
  p.own.on_writer_gone(hostile, p.now);
  CHECK(p.own.deadline() == p.now + 30s);
  CHECK(p.own.take_orphans(p.now + 29s).empty());
  CHECK(p.own.take_orphans(p.now + 30s) == std::vector{name_of("large")});
  CHECK(!p.own.deadline());
  CHECK(p.own.counters().orphans_removed == 1);
}

} // namespace rubicon::peis
