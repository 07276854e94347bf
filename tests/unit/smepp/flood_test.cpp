// Attackers without keys, who say what they have overheard, often.
#include <algorithm>

#include "support/catch.hpp"
#include "unit/smepp/intruder.hpp"

using namespace rubicon;
using namespace rubicon::smepp;
using namespace rubicon::smepp::test;

TEST_CASE("frames that were overheard and changed keep no radio on", "[smepp][SMP-03][SMP-23]") {
  for (const duration period : {1s, 2s, 10s, 60s}) {
    double shares[2] = {};
    for (const bool attacked : {false, true}) {
      world w({.peers = 3});
      const auto group = w.build_group(kitchen(period));
      w.run_for(10min + 5 * period);
      w.power_off(3); // a neighbour that has gone, whose name is used
      security own({.self = mote_id{3}}, 900);
      own.set_network_keys(w.network, instant{});
      own.set_group(group, group_of(w, 2, group).ring.accepted());
      const auto real =
          *own.seal(broadcast_mote, group, group_of(w, 2, group).ring.best().id, bytes(20, 0));
      auto forged = real;
      forged[1] = static_cast<std::uint8_t>((real[1] & 0xf0) | ((real[1] + 1) & 0x0f));
      const auto on_before = w.radio_time(2);
      const auto from = w.now();
      while (w.now() - from < 2h) {
        if (attacked && w.at(2).is_radio_on())
          w.inject(2, mote_id{3}, broadcast_mote, forged);
        w.run_for(period / 20);
      }
      shares[attacked ? 1 : 0] = seconds(w.radio_time(2) - on_before) / seconds(w.now() - from);
    }
    CAPTURE(seconds(period), shares[0], shares[1]);
    CHECK(shares[1] < shares[0] + 0.005);
  }
}

TEST_CASE("false rumours do not keep a member from true ones", "[smepp][SMP-03][SMP-13]") {
  for (const duration period : {1s, 2s, 10s}) {
    world w({.peers = 3});
    const auto group = w.build_group(kitchen(period));
    REQUIRE(w.agree(group, all_of(w)));
    w.run_for(10min);
    w.cut([](std::size_t a, std::size_t b) { return a == 3 || b == 3; });
    for (int i = 0; i < 3; ++i) {
      w.with(1, [&](peer& each, instant t, outputs& out) {
        return each.refresh_session_keys(group, t, out);
      });
      w.run_for(3min + 10 * period);
    }
    security own({.self = mote_id{9}}, 900);
    own.set_network_keys(w.network, instant{});
    own.set_group(group, group_of(w, 3, group).ring.accepted());
    auto forged =
        *own.seal(broadcast_mote, group, group_of(w, 3, group).ring.best().id, bytes(20, 0));
    forged[1] = static_cast<std::uint8_t>((forged[1] & 0xf0) | ((forged[1] + 1) & 0x0f));
    std::uint16_t name = 9;
    const auto flood = [&](duration length) {
      const auto from = w.now();
      while (w.now() - from < length) {
        if (w.at(3).is_radio_on())
          for (int i = 0; i < 3; ++i)
            w.inject(3, mote_id{static_cast<std::uint16_t>(9 + ++name % 90)}, broadcast_mote,
                     forged);
        w.run_for(50ms);
        if (w.agree(group, all_of(w)))
          return;
      }
    };
    flood(1min);
    w.cut({});
    const auto from = w.now();
    flood(30min);
    CAPTURE(seconds(period), seconds(w.now() - from));
    CHECK(w.agree(group, all_of(w)));
    CHECK(w.now() - from < 5min + 20 * period);
  }
}

TEST_CASE("recorded joins keep no peer out", "[smepp][SMP-03][SMP-09]") {
  int joined = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    world w({.peers = 3, .seed = seed});
    w.record_air(true);
    const auto group = create(w, 2, kitchen());
    REQUIRE_FALSE(w.join(1, group, key_of(9), {}));
    w.join(3, group, key_of(8), {}); // in vain, but it was recorded
    std::vector<heard_frame> recorded;
    for (const auto& x : w.air())
      if (x.what == "join" || x.what == "join_proof")
        recorded.push_back(x);
    REQUIRE(recorded.size() >= 4);
    w.run_for(2min);
    const auto replay = [&](duration length) {
      const auto from = w.now();
      while (w.now() - from < length && !is_in(w, 3, group)) {
        for (const auto& x : recorded)
          w.inject(2, x.from, x.to, x.octets);
        w.run_for(250ms);
      }
    };
    replay(1min);
    const auto before = w.at(2).groups().counters().agreements;
    w.with(3, [&](peer& each, instant t, outputs& out) { each.smepp_getGroups({}, t, out); });
    replay(4s);
    w.with(3, [&](peer& each, instant t, outputs& out) {
      each.smepp_joinGroup(group, key_of(9), t, out);
    });
    replay(20s);
    joined += is_in(w, 3, group) ? 1 : 0;
    CHECK(w.at(2).groups().counters().agreements - before <= 3); // of the one that was let in
  }
  CHECK(joined == 10);
}

TEST_CASE("a recorded proof costs a member that has forgotten it nothing",
          "[smepp][SMP-03][SMP-09]") {
  world w({.peers = 2});
  w.record_air(true);
  const auto group = create(w, 2, kitchen());
  REQUIRE_FALSE(w.join(1, group, key_of(9), {}));
  const auto recorded = *std::ranges::find(w.air(), "join_proof", &heard_frame::what);
  w.power_off(2);
  w.run_for(2min);
  w.power_on(2);
  w.run_for(2min);
  REQUIRE(w.agree(group, {1, 2}));
  const auto before = w.at(2).groups().counters();
  const auto keys = group_of(w, 2, group).ring.best().id;
  for (int i = 0; i < 4; ++i) {
    w.inject(2, recorded.from, recorded.to, recorded.octets);
    w.run_for(1min + 1s); // until its counter is taken again
  }
  const auto& after = w.at(2).groups().counters();
  CHECK(after.dropped.contains("old_cookie"));
  CHECK(after.agreements == before.agreements);
  CHECK(group_of(w, 2, group).ring.best().id == keys);
}

TEST_CASE("recorded joins keep no member from new keys", "[smepp][SMP-03][SMP-12]") {
  world w({.peers = 4});
  w.record_air(true);
  const auto group = w.build_group(kitchen(2s));
  REQUIRE(w.agree(group, all_of(w)));
  std::vector<heard_frame> recorded;
  for (const auto& x : w.air())
    if (x.what == "join" || x.what == "join_proof")
      recorded.push_back(x);
  w.run_for(3min);
  w.leave(4, group);
  const auto from = w.now();
  while (w.now() - from < 5min) {
    for (const auto& x : recorded)
      w.inject(x.to.value, x.from, x.to, x.octets);
    w.run_for(250ms);
  }
  CHECK(w.agree(group, {1, 2, 3}));
  CHECK(group_of(w, 1, group).members.present() == 3);
}

TEST_CASE("a recorded question is hardly ever answered", "[smepp][SMP-03][SMP-06]") {
  world w({.peers = 2});
  w.record_air(true);
  create(w, 1, kitchen());
  static_cast<void>(w.find_groups(2, {}));
  const auto question = *std::ranges::find(w.air(), "discover", &heard_frame::what);
  w.run_for(2min);
  const auto before = sent(w, 1, "answer");
  for (int i = 0; i < 600; ++i) {
    w.inject(1, question.from, question.to, question.octets);
    w.run_for(1s);
  }
  CHECK(sent(w, 1, "answer") - before <= 10);
}

TEST_CASE("who has no counter left refuses, and goes on", "[smepp][SMP-03][SMP-22]") {
  world w({.peers = 2});
  persistent_state used_up;
  used_up.counter_reserved = used_up.counter_end = 5000;
  peer x({.self = mote_id{1}}, random_stream(1), w.now(), used_up);
  outputs out;
  x.smepp_newPeer(w.network.confidentiality, w.network.integrity, w.now(), out);
  const auto group = std::get<group_id>(x.smepp_createGroup(kitchen(), w.now(), out));
  security other({.self = mote_id{2}}, 0);
  other.set_network_keys(w.network, w.now());
  for (const message& each : {message(discover{1, {}, {}, {}, ""}), message(join{group, 7})}) {
    const auto frame = *other.seal(mote_id{1}, network_level, {}, encode(each));
    x.on_frame(mote_id{2}, mote_id{1}, frame, w.now(), w.now(), out);
    x.on_time(w.now() + 1s, out);
  }
  x.smepp_getGroups({}, w.now() + 2s, out);
  x.on_time(w.now() + 3s, out);
  std::size_t results = 0;
  for (const auto& each : out) {
    CHECK_FALSE(std::holds_alternative<send_frame>(each));
    const auto* const raised = std::get_if<signal>(&each);
    results += raised != nullptr && std::holds_alternative<getGroups_result>(*raised) ? 1U : 0U;
  }
  CHECK(results == 1);
  CHECK(x.keys().counters().used_up > 0);
}
