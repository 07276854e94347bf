#include "support/catch.hpp"
#include "unit/smepp/intruder.hpp"

using namespace rubicon;
using namespace rubicon::smepp;
using namespace rubicon::smepp::test;

namespace {

group_description described_kitchen(bool closed = true, bool hidden = false) {
  group_description x;
  x.name = "kitchen";
  x.is_closed = closed;
  x.is_private = hidden;
  if (closed || hidden)
    x.master = key_of(9);
  return x;
}

std::size_t count(const world& w, std::string_view what) {
  return static_cast<std::size_t>(
      std::ranges::count(w.air(), what, [](const heard_frame& x) { return x.what; }));
}

} // namespace

TEST_CASE("a peer's id is its mote's", "[smepp][SMP-01]") {
  peer x({.self = mote_id{17}}, random_stream(1), instant{});
  outputs out;
  CHECK(x.smepp_newPeer(key_of(1), key_of(2), instant{}, out) == mote_id{17});
}

TEST_CASE("a group is created at once and without a frame", "[smepp][SMP-04]") {
  peer x({.self = mote_id{1}}, random_stream(1), instant{});
  outputs out;
  x.smepp_newPeer(key_of(1), key_of(2), instant{}, out);
  const auto group = std::get<group_id>(x.smepp_createGroup(described_kitchen(), instant{}, out));
  for (const auto& each : out)
    CHECK_FALSE(std::holds_alternative<send_frame>(each));
  CHECK(x.smepp_getGroupDescription(group) == described_kitchen());
  CHECK(x.smepp_getPeers(group) == std::vector<peer_description>{{mote_id{1}, 0}});
  CHECK(std::get<failure>(x.smepp_createGroup(described_kitchen(), instant{}, out)) ==
        failure::name_taken);
  CHECK(std::get<failure>(x.smepp_createGroup({}, instant{}, out)) == failure::bad_argument);
  for (const char* name : {"a", "b", "c"})
    x.smepp_createGroup({.name = name}, instant{}, out);
  CHECK(std::get<failure>(x.smepp_createGroup({.name = "d"}, instant{}, out)) == failure::no_room);
}

TEST_CASE("a key opens closed groups and shows private ones", "[smepp][SMP-05][SMP-06][SMP-09]") {
  for (const bool closed : {false, true})
    for (const bool hidden : {false, true}) {
      world w({.peers = 2});
      const auto group = create(w, 1, described_kitchen(closed, hidden));
      const auto found = w.find_groups(2, {});
      CHECK(found == (hidden ? std::vector<group_id>{} : std::vector{group}));
      CHECK(w.find_groups(2, {.master = key_of(8)}).empty() == hidden);
      CHECK(w.find_groups(2, {.master = key_of(9)}) == std::vector{group});
      const auto description = w.at(2).smepp_getGroupDescription(group); // SMP-08
      REQUIRE(description);
      CHECK(description->name == "kitchen");
      CHECK(description->is_closed == closed);
      CHECK(description->is_private == hidden);
      if (closed) {
        w.forget_air();
        w.record_air(true);
        CHECK(w.join(2, group, key_of(8), {.master = key_of(9)}) == failure::wrong_master_key);
        CHECK(count(w, "join_accept") == 0); // no key material was sent
        CHECK(count(w, "join_refuse") >= 1);
        CHECK(w.at(2).groups().find(group) == nullptr);
      }
      // Who has a key enters no group without one, whatever it is said to be.
      if (!closed && !hidden)
        CHECK(w.join(2, group, std::nullopt, {.master = key_of(9)}) == failure::wrong_master_key);
      const auto looked_for = hidden ? std::optional(key_of(9)) : std::nullopt;
      CHECK(w.join(2, group, closed ? std::optional(key_of(9)) : std::nullopt,
                   {.master = looked_for}) == std::nullopt);
      CHECK(w.at(2).smepp_getPeers(group).size() == 2);
    }
}

TEST_CASE("groups are found by what is asked for, all of a member",
          "[smepp][SMP-06][SMP-07][SMP-08]") {
  world w({.peers = 2});
  const auto open = create(w, 1, {.name = "open"});
  auto x = described_kitchen();
  const auto closed = create(w, 1, x);
  CHECK(w.find_groups(2, {}).size() == 2);
  CHECK(w.find_groups(2, {.is_closed = true}) == std::vector{closed});
  CHECK(w.find_groups(2, {.is_closed = false}) == std::vector{open});
  CHECK(w.find_groups(2, {.name = "open"}) == std::vector{open});
  CHECK(w.find_groups(2, {.name = "bath"}).empty());
  CHECK(w.find_groups(2, {.is_private = true}).empty());
  CHECK_FALSE(w.at(2).smepp_getGroupDescription(open)); // no longer found
}

TEST_CASE("a sleeping group is found within one period", "[smepp][SMP-25]") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    world w({.peers = 2, .seed = seed});
    auto x = described_kitchen();
    x.management = {2s, 80ms};
    const auto group = create(w, 1, x);
    w.run_for(30s + std::chrono::milliseconds(97 * seed));
    const auto on_before = w.radio_time(1);
    w.run_for(10s);
    CHECK(w.radio_time(1) - on_before < 1s); // it does sleep
    w.with(2, [](peer& each, instant t, outputs& out) { each.smepp_getGroups({}, t, out); });
    const auto from = w.now();
    CHECK(w.run_until([&] { return w.at(2).groups().found().find(group) != nullptr; }, 3s, 10ms));
    CHECK(w.now() - from <= 2s + 100ms);
    REQUIRE(w.run_until([&] { return !w.signals<getGroups_result>(2).empty(); }, 4s));
    const auto schedule = w.at(2).groups().schedule_of(group, w.local(2));
    REQUIRE(schedule);
    CHECK(schedule->cycle == x.management);
    const auto error = schedule->now - w.at(1).groups().find(group)->sync.at(w.local(1));
    CHECK(std::chrono::abs(error) < 10ms);
  }
}

TEST_CASE("all members are notified of a new one, and it of them",
          "[smepp][SMP-09][SMP-10][SMP-11]") {
  world w({.peers = 4});
  const auto group = w.build_group(described_kitchen());
  REQUIRE(w.agree(group, {1, 2, 3, 4}));
  const peer_description fourth{mote_id{4}, 1U << 3};
  for (std::size_t i = 1; i <= 3; ++i) {
    const auto joined = w.signals<peerJoined>(i);
    CHECK(std::ranges::count(joined, peerJoined{group, fourth}) == 1);
  }
  const auto peers = w.at(2).smepp_getPeers(group);
  CHECK(peers == w.at(4).smepp_getPeers(group));
  CHECK(peers ==
        std::vector<peer_description>{{mote_id{1}, 1}, {mote_id{2}, 2}, {mote_id{3}, 4}, fourth});
  CHECK(w.signals<joinGroup_result>(4) == std::vector<joinGroup_result>{{group, {}, std::nullopt}});
}

TEST_CASE("a join that cannot be is reported", "[smepp][SMP-22]") {
  world w({.peers = 3}, [](peer_config& x) {
    x.groups.admits = x.self != mote_id{1};
    x.groups.members_max = 2;
  });
  const auto group = create(w, 1, described_kitchen());
  CHECK(w.join(3, group, key_of(9), {}) == failure::unknown_group); // out of reach
  CHECK(w.join(2, group, key_of(9), {}) == failure::not_admitted);
  CHECK(w.join(2, group, std::nullopt, {}) == failure::wrong_master_key);
  w.power_off(1);
  w.with(2, [&](peer& each, instant t, outputs& out) {
    each.smepp_joinGroup(group, key_of(9), t, out);
  });
  w.forget_signals();
  w.run_for(30s);
  CHECK(w.signals<joinGroup_result>(2).front().error == failure::no_answer);
  CHECK(w.leave(2, group) == failure::not_a_member);
  CHECK(w.subscribe(2, group, "light") == failure::not_a_member);

  const auto other = create(w, 2, {.name = "full"});
  CHECK(w.join(3, other, std::nullopt, {}) == std::nullopt);
  w.power_on(1);
  CHECK(w.join(1, other, std::nullopt, {}) == failure::group_full);
}

TEST_CASE("the provisioned master key is the only one that is taken", "[smepp][SMP-13]") {
  world w({.peers = 2}, [](peer_config& x) {
    if (x.self == mote_id{2})
      x.masters["kitchen"] = key_of(9);
  });
  const auto group = create(w, 1, described_kitchen());
  CHECK(w.join(2, group, key_of(8), {}) == failure::wrong_master_key);
  CHECK(w.join(2, group, std::nullopt, {}) == std::nullopt);
}

TEST_CASE("who leaves is notified when it is done, as are all others", "[smepp][SMP-12]") {
  world w({.peers = 4});
  const auto group = w.build_group(described_kitchen());
  const auto before = w.at(1).groups().find(group)->ring.best().id;
  w.forget_signals();
  CHECK(w.leave(3, group) == std::nullopt);
  CHECK(w.signals<peerLeft>(3).empty()); // split-phase
  CHECK(w.leave(3, group) == failure::not_a_member);
  w.run_for(30s);
  const peerLeft gone{mote_id{3}, group};
  CHECK(w.signals<peerLeft>(3) == std::vector{gone});
  CHECK(w.signals<peerLeft>(1) == std::vector{gone});
  CHECK(w.signals<peerLeft>(2) == std::vector{gone});
  CHECK(w.at(3).groups().find(group) == nullptr);
  CHECK(w.at(1).smepp_getPeers(group).size() == 3);
  // The keys have changed, by the lowest member that is there.
  const auto after = w.at(1).groups().find(group)->ring.best().id;
  CHECK(is_better(after, before));
  CHECK(after.maker == mote_id{1});
  CHECK(w.agree(group, {1, 2}));
  CHECK(w.join(3, group, key_of(9), {}) == std::nullopt); // and back again
  w.run_for(60s);                                         // peer 4, behind it, catches up
  CHECK(w.agree(group, {1, 2, 3, 4}));
}

TEST_CASE("session keys change with who is in the group, and every now and then",
          "[smepp][SMP-13]") {
  world w({.peers = 3}, [](peer_config& x) { x.groups.key_period = 1h; });
  const auto group = w.build_group(described_kitchen());
  const auto first = w.at(1).groups().find(group)->ring.best().id;
  CHECK(first.generation == 3); // created, two joined
  w.run_for(61min);
  const auto second = w.at(3).groups().find(group)->ring.best().id;
  CHECK(second.generation == 4);
  CHECK(second.maker == mote_id{1});
  CHECK(w.agree(group, {1, 2, 3}));
  w.power_off(1); // the next in line does it
  w.run_for(62min);
  CHECK(w.at(3).groups().find(group)->ring.best().id == session_id{5, mote_id{2}});
  CHECK(w.agree(group, {2, 3}));
}

TEST_CASE("a change of keys loses no event", "[smepp][SMP-13]") {
  for (const duration period : {0s, 1s}) {
    world w({.peers = 4, .loss = 0.05, .seed = 3});
    auto x = described_kitchen();
    x.management.period = period;
    const auto group = w.build_group(x);
    CHECK(w.subscribe(1, group, "light") == std::nullopt);
    w.run_for(10s);
    std::size_t raised = 0;
    for (int i = 0; i < 60; ++i) {
      if (i % 20 == 5)
        w.with(2, [&](peer& each, instant t, outputs& out) {
          return each.refresh_session_keys(group, t, out);
        });
      raised += w.raise(4, group, "light") ? 0U : 1U;
      w.run_for(2s);
    }
    w.run_for(10s);
    CHECK(w.signals<receive_result>(1).size() == raised);
    CHECK(w.agree(group, {1, 2, 3, 4}));
  }
}

TEST_CASE("in wall time no secret is derived from the seed", "[smepp][SMP-13]") {
  for (const bool is_wall_time : {false, true}) {
    const auto secrets = [&] {
      outputs out;
      peer x({.self = mote_id{1}, .has_system_randomness = is_wall_time}, random_stream(1),
             instant{});
      x.smepp_newPeer(key_of(1), key_of(2), instant{}, out);
      const auto group =
          std::get<group_id>(x.smepp_createGroup({.name = "meadow"}, instant{}, out));
      return std::pair(x.groups().find(group)->ring.best().keys,
                       std::get<store_state>(out.front()).content.identity);
    };
    const auto [keys, identity] = secrets();
    const auto [other_keys, other_identity] = secrets();
    CHECK((keys == other_keys) != is_wall_time);
    CHECK((identity == other_identity) != is_wall_time);
  }
}

TEST_CASE("network keys change while the group goes on", "[smepp][SMP-02]") {
  world w({.peers = 3});
  const auto group = w.build_group(described_kitchen());
  CHECK(w.subscribe(1, group, "light") == std::nullopt);
  w.run_for(5s);
  const auto change = [&](std::size_t i) {
    w.with(i, [](peer& each, instant t, outputs& out) {
      each.set_network_keys(key_of(31), key_of(32), t, out);
    });
  };
  const auto received = [&] {
    w.raise(2, group, "light");
    w.run_for(1s);
    return w.signals<receive_result>(1).size();
  };
  CHECK(received() == 1);
  change(1); // one after the other: 1 still takes what 2 says
  CHECK(received() == 2);
  w.run_for(5s);
  change(2);
  CHECK(received() == 3);
  w.run_for(2min); // peer 3 was left behind
  w.raise(3, group, "light");
  w.run_for(20s);
  CHECK(w.signals<receive_result>(1).size() == 3);
  CHECK(w.at(2).keys().counters().refused.at("wrong_key") > 0);
  change(3);
  w.run_for(2min);
  w.raise(3, group, "light");
  w.run_for(20s);
  CHECK(w.signals<receive_result>(1).size() == 4);
}

TEST_CASE("a peer may be in several groups", "[smepp][SMP-14]") {
  world w({.peers = 3});
  const auto left = create(w, 1, described_kitchen());
  const auto right = create(w, 3, {.name = "bath"});
  CHECK(w.join(2, left, key_of(9), {}) == std::nullopt);
  CHECK(w.join(2, right, std::nullopt, {}) == std::nullopt);
  w.subscribe(2, left, "light");
  w.subscribe(2, right, "light");
  w.run_for(20s);
  w.raise(1, left, "light", {1});
  w.raise(3, right, "light", {3});
  w.run_for(5s);
  const auto got = w.signals<receive_result>(2);
  REQUIRE(got.size() == 2);
  CHECK(std::ranges::count(got, receive_result{mote_id{1}, left, "light", {1}}) == 1);
  CHECK(std::ranges::count(got, receive_result{mote_id{3}, right, "light", {3}}) == 1);
  CHECK(w.at(1).keys().counters().refused.count("unknown_group") == 1); // it hears the other one
}

TEST_CASE("state on a mote is accounted for", "[smepp][SMP-30]") {
  world w({.peers = 2});
  w.build_group(described_kitchen());
  const auto octets = w.at(1).footprint();
  CAPTURE(octets);
  CHECK(octets > 1000);
  CHECK(octets < 6500); // of 8 KB (D1.1 3.4.1)
}
