// Attackers with keys: what each can do, and for how long.
#include <algorithm>

#include "support/catch.hpp"
#include "unit/smepp/intruder.hpp"

using namespace rubicon;
using namespace rubicon::smepp;
using namespace rubicon::smepp::test;

// ---- into another group

TEST_CASE("who has a master key enters no group without it", "[smepp][SMP-05][SMP-09]") {
  for (const auto& [is_closed, is_provisioned] : {std::pair(false, false), std::pair(false, true),
                                                  std::pair(true, false), std::pair(true, true)}) {
    CAPTURE(is_closed, is_provisioned);
    // 1 is an impostor that has the network's keys, 3 is true
    world w({.peers = 3}, [has_key = is_provisioned](peer_config& x) {
      if (has_key && x.self == mote_id{2})
        x.masters["kitchen"] = key_of(9);
    });
    auto false_one = kitchen();
    false_one.is_closed = is_closed;
    false_one.master = is_closed ? std::optional(key_of(66)) : std::nullopt;
    const auto rogue = create(w, 1, false_one);
    const auto genuine = create(w, 3, kitchen());
    CHECK(w.join(2, rogue, key_of(9), {.name = "kitchen"}) == failure::wrong_master_key);
    CHECK(w.join(2, rogue, std::nullopt, {.name = "kitchen", .master = key_of(9)}) ==
          failure::wrong_master_key);
    w.run_for(30s);
    if (is_provisioned)
      CHECK(w.join(2, rogue, std::nullopt, {.name = "kitchen"}) == failure::wrong_master_key);
    CHECK_FALSE(is_in(w, 2, rogue));
    CHECK(w.at(1).smepp_getPeers(rogue).size() == 1);
    // Who looks with the key sees who has it first.
    CHECK(w.find_groups(2, {.name = "kitchen", .master = key_of(9)}).front() == genuine);
    CHECK(w.join(2, genuine, key_of(9), {.name = "kitchen", .master = key_of(9)}) == std::nullopt);
  }
}

TEST_CASE("what others say of a group does not hold up who joins it", "[smepp][SMP-08][SMP-09]") {
  for (const bool with_key : {false, true})
    for (const std::uint16_t name :
         std::initializer_list<std::uint16_t>{1, 9}) { // the member's own, or another
      world w({.peers = 2});
      w.record_air(true);
      const auto group = create(w, 1, kitchen(2s));
      w.run_for(10s);
      intruder who(w);
      group_filter filter{.name = "kitchen"};
      if (with_key)
        filter.master = key_of(9);
      w.with(2, [&](peer& each, instant t, outputs& out) { each.smepp_getGroups(filter, t, out); });
      for (int i = 0; i < 30; ++i) {
        w.run_for(100ms);
        const auto questions = who.overheard<discover>(mote_id{2}, broadcast_mote);
        REQUIRE_FALSE(questions.empty());
        for (const std::uint16_t period : std::initializer_list<std::uint16_t>{65000, 500})
          who.say(2, mote_id{name}, mote_id{2},
                  answer{questions.back().nonce,
                         group,
                         true,
                         false,
                         1,
                         period,
                         100,
                         {},
                         std::nullopt,
                         to_bytes(std::string_view("kitchen"))});
      }
      REQUIRE(w.run_until([&] { return !w.signals<getGroups_result>(2).empty(); }, 10s));
      const auto from = w.now();
      w.with(2, [&](peer& each, instant t, outputs& out) {
        each.smepp_joinGroup(group, key_of(9), t, out);
      });
      CHECK(w.run_until([&] { return !w.signals<joinGroup_result>(2).empty(); }, 30s));
      CHECK(w.now() - from < 30s);
      REQUIRE(is_in(w, 2, group));
      CHECK(group_of(w, 2, group).description == kitchen(2s));
    }
}

TEST_CASE("a forged refusal ends no join", "[smepp][SMP-09]") {
  for (const auto why : {failure::wrong_master_key, failure::group_full, failure::not_admitted}) {
    world w({.peers = 2});
    w.record_air(true);
    const auto group = create(w, 1, kitchen());
    static_cast<void>(w.find_groups(2, {}));
    intruder who(w);
    w.with(2, [&](peer& each, instant t, outputs& out) {
      each.smepp_joinGroup(group, key_of(9), t, out);
    });
    for (int i = 0; i < 20 && !is_in(w, 2, group); ++i) {
      w.run_for(1ms);
      const auto asked = who.overheard<join>(mote_id{2}, mote_id{1});
      if (!asked.empty())
        who.say(2, mote_id{1}, mote_id{2}, join_refuse{group, asked.back().nonce, why, {}});
    }
    w.run_for(70s);
    REQUIRE(is_in(w, 2, group));
  }
}

// ---- in another's name

TEST_CASE("who has left does not read on in a member's name", "[smepp][SMP-12][SMP-13]") {
  for (const bool is_open : {false, true})
    for (const bool as_member : {true, false}) {
      world w({.peers = 4});
      auto x = kitchen();
      if (is_open)
        x = {.name = "kitchen"};
      const auto group = w.build_group(x);
      REQUIRE(w.agree(group, all_of(w)));
      w.run_for(2min);
      const auto before = group_of(w, 2, group).ring.best().id;
      w.forget_signals();
      randomness secrets{random_stream(56)};
      const auto identity = agreement::make(secrets);
      const auto result =
          enter_as(w, 2, mote_id{3}, x, group, as_member, identity, identity.share());
      CHECK(result.was_admitted); // it has the credential,
      for (const std::size_t i : {1, 2}) {
        w.run_for(5s);
        INFO(i);
        CHECK(w.signals<peerJoined>(i).size() >= 1); // and those behind whom it is not see it
      }
      w.run_for(2min);
      CHECK(is_better(group_of(w, 2, group).ring.best().id, before));
      CHECK(w.agree(group, all_of(w)));
      // Member 3 has said that it is itself, and the keys that the other one got are old.
      CHECK(group_of(w, 1, group).ring.best().id.generation >= before.generation + 2);
    }
}

TEST_CASE("a member's identity shown by another opens nothing", "[smepp][SMP-12][SMP-13]") {
  world w({.peers = 3});
  w.record_air(true);
  const auto group = w.build_group(kitchen());
  intruder who(w);
  const auto shown = who.overheard<join_proof>(mote_id{3}, mote_id{2});
  REQUIRE_FALSE(shown.empty());
  w.run_for(2min);
  const auto before = group_of(w, 2, group).ring.best().id;
  randomness secrets{random_stream(57)};
  const auto other = agreement::make(secrets);
  const auto result =
      enter_as(w, 2, mote_id{3}, kitchen(), group, true, other, shown.back().identity);
  CHECK(result.was_admitted);
  CHECK_FALSE(result.has_keys);
  CHECK(group_of(w, 2, group).ring.best().id == before);
}

TEST_CASE("a member that catches up is no reason for new keys", "[smepp][SMP-13][SMP-22]") {
  world w({.peers = 3});
  const auto group = w.build_group(kitchen());
  w.run_for(2min);
  w.power_off(3);
  w.run_for(10s);
  w.forget_signals();
  const auto before = group_of(w, 1, group).ring.best().id;
  w.power_on(3);
  w.run_for(2min);
  CHECK(w.agree(group, all_of(w)));
  CHECK(group_of(w, 1, group).ring.best().id == before);
  CHECK(w.signals<peerJoined>(1).empty());
}

// ---- windows

TEST_CASE("one frame silences no peer", "[smepp][SMP-03][SMP-13]") {
  for (const bool answers : {false, true}) { // does it answer in the member's name, too?
    world w({.peers = 3});
    const auto group = w.build_group(kitchen());
    w.subscribe(1, group, "light");
    w.run_for(10s);
    const auto keys = group_of(w, 2, group).ring.accepted();
    const auto session = keys.front().id;
    const auto forged = unsubscribe{{mote_id{50}, 1}, {}};
    intruder far(w, 0xffff'ff00);
    w.record_air(true);
    far.say(2, mote_id{3}, broadcast_mote, forged, group, session, keys);
    if (answers) {
      w.run_for(3ms);
      for (int i = 0; i < 20; ++i) {
        w.run_for(1ms);
        for (const auto& x : w.air()) {
          security own({.self = mote_id{3}}, 0);
          own.set_network_keys(w.network, w.now());
          own.set_group(group, keys);
          const auto opened = own.open(x.from, x.to, x.octets, w.now());
          const auto* const frame = std::get_if<opened_frame>(&opened);
          if (frame == nullptr || x.what != "challenge" || x.to != mote_id{3})
            continue;
          const auto said = decode(frame->content);
          far.say(2, mote_id{3}, mote_id{2}, proof{std::get<challenge>(*said).nonce}, group,
                  session, keys);
        }
      }
    }
    w.run_for(5s);
    if (answers) // members may lie; what they can do ends with the keys that they have
      w.with(1, [&](peer& each, instant t, outputs& out) {
        return each.refresh_session_keys(group, t, out);
      });
    w.run_for(2min);
    w.forget_signals();
    for (int i = 0; i < 10; ++i) {
      w.raise(3, group, "light");
      w.run_for(2s);
    }
    CHECK(w.signals<receive_result>(1).size() >= (answers ? 9 : 10));
  }
}

// ---- who said it

TEST_CASE("a proven event is taken once, and no false one in its place",
          "[smepp][SMP-03][SMP-13]") {
  world w({.peers = 3}, [](peer_config& x) { prove_senders(x, 3, key_of(77)); });
  const auto group = w.build_group(kitchen());
  w.subscribe(1, group, "alarm");
  w.run_for(10s);
  w.record_air(true);
  w.raise(3, group, "alarm", {1});
  w.run_for(1s);
  REQUIRE(w.signals<receive_result>(1).size() == 1);
  const auto keys = group_of(w, 2, group).ring.accepted();
  smepp::event seen{};
  for (const auto& x : w.air()) {
    security own({.self = x.to}, 0);
    own.set_network_keys(w.network, w.now());
    own.set_group(group, keys);
    const auto opened = own.open(x.from, x.to, x.octets, w.now());
    if (const auto* const frame = std::get_if<opened_frame>(&opened); frame && x.what == "event")
      seen = std::get<smepp::event>(*decode(frame->content));
  }
  REQUIRE(seen.proof);
  for (std::uint8_t i = 0; i < 40; ++i) {
    w.raise(3, group, "alarm", {i});
    w.run_for(1s);
  }
  REQUIRE(w.signals<receive_result>(1).size() == 41);
  intruder relay(w, 30'000); // member 2 itself
  relay.say(1, mote_id{2}, mote_id{1}, seen, group, keys.front().id, keys);
  CHECK(w.signals<receive_result>(1).size() == 41);

  SECTION("a false one with the next number, at the subscriber and on the route") {
    auto lie = seen;
    for (std::uint16_t i = 0; i < 3; ++i) {
      lie.sequence = static_cast<std::uint16_t>(seen.sequence + 41 + i);
      lie.value = {99};
      for (const std::size_t at : {1, 2})
        relay.say(at, mote_id{static_cast<std::uint16_t>(3 - at)},
                  mote_id{static_cast<std::uint16_t>(at)}, lie, group, keys.front().id, keys);
      w.run_for(1s);
    }
    w.with(1, [&](peer& each, instant t, outputs& out) { // ends what it did to windows
      return each.refresh_session_keys(group, t, out);
    });
    w.run_for(30s);
    w.raise(3, group, "alarm", {1});
    w.run_for(2s);
    CHECK(w.signals<receive_result>(1).size() == 42);
  }
  SECTION("in the subscriber's own name") {
    auto lie = seen;
    lie.producer = mote_id{1};
    relay.say(1, mote_id{2}, mote_id{1}, lie, group, keys.front().id, keys);
    CHECK(w.signals<receive_result>(1).size() == 41);
  }
  SECTION("for a subscription of a former life") {
    w.with(1, [&](peer& each, instant t, outputs& out) {
      return each.smepp_unsubscribe("alarm", group, t, out);
    });
    w.run_for(10s);
    w.subscribe(1, group, "alarm");
    w.run_for(10s);
    auto again = seen;
    again.id = w.at(1).events().all().at(0).id;
    relay.say(1, mote_id{2}, mote_id{1}, again, group, keys.front().id, keys);
    CHECK(w.signals<receive_result>(1).size() == 41);
  }
}
