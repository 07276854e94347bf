#include "support/catch.hpp"
#include "unit/smepp/world.hpp"

using namespace rubicon;
using namespace rubicon::smepp;
using namespace rubicon::smepp::test;

namespace {

group_description managed_kitchen(duration period = 0s) {
  return {.name = "kitchen", .management = {period, 100ms}};
}

std::vector<std::uint8_t> depths(world& w) {
  std::vector<std::uint8_t> all;
  for (std::size_t i = 1; i <= w.size(); ++i)
    for (const auto& x : w.at(i).events().all())
      all.push_back(x.depth);
  return all;
}

} // namespace

TEST_CASE("a subscription spans the group, as deep as the hops", "[smepp][SMP-15]") {
  world w({.peers = 9, .columns = 3});
  const auto group = w.build_group(managed_kitchen());
  CHECK(w.subscribe(1, group, "light", 0.5, 1h) == std::nullopt);
  w.run_for(5s);
  CHECK(depths(w) == std::vector<std::uint8_t>{0, 1, 2, 1, 2, 3, 2, 3, 4});
  for (std::size_t i = 2; i <= 9; ++i) {
    const auto received = w.signals<subscribed>(i);
    REQUIRE(received.size() == 1);
    CHECK(received[0].group == group);
    CHECK(received[0].what.name == "light");
    CHECK(received[0].what.interval == 2s);
    REQUIRE(received[0].what.expires);
    CHECK(std::chrono::abs(*received[0].what.expires - received[0].what.offset - 1h) < 1s);
  }
}

TEST_CASE("members sample at the same time", "[smepp][SMP-16][SMP-26]") {
  world w({.peers = 5, .loss = 0.05, .crystals_ppm = 100, .seed = 4});
  const auto group = w.build_group(managed_kitchen(2s));
  w.run_for(5min);
  w.subscribe(1, group, "light", 0.1);
  w.run_for(30s);
  std::vector<instant> offsets;
  for (std::size_t i = 2; i <= 5; ++i) {
    const auto received = w.signals<subscribed>(i);
    REQUIRE(received.size() == 1);
    offsets.push_back(w.world_time(i, received[0].what.offset));
  }
  const auto [first, last] = std::ranges::minmax(offsets);
  CHECK(last - first < 1ms);
}

TEST_CASE("events above the rate are suppressed", "[smepp][SMP-17]") {
  world w({.peers = 2});
  const auto group = w.build_group(managed_kitchen());
  w.subscribe(1, group, "light", 1);
  w.run_for(5s);
  for (int i = 0; i < 200; ++i) {
    w.raise(2, group, "light");
    w.run_for(100ms);
  }
  const auto got = w.signals<receive_result>(1).size();
  CHECK(got >= 20);
  CHECK(got <= 21);
  CHECK(w.at(2).events().counters().suppressed == 200 - got);
}

TEST_CASE("a subscription expires with its tree", "[smepp][SMP-18]") {
  world w({.peers = 3});
  const auto group = w.build_group(managed_kitchen());
  w.subscribe(1, group, "light", 0, 5min);
  w.run_for(299s);
  CHECK(depths(w).size() == 3);
  w.raise(3, group, "light");
  w.run_for(2s);
  CHECK(depths(w).empty());
  w.raise(3, group, "light");
  w.run_for(2s);
  CHECK(w.signals<receive_result>(1).size() == 1);
  CHECK(w.signals<unsubscribed>(3).size() == 1);
  w.subscribe(1, group, "light", 0, 5min);
  w.run_for(2s);
  CHECK(depths(w).size() == 3);
}

TEST_CASE("every matching subscriber gets an event, others none", "[smepp][SMP-19][SMP-20]") {
  world w({.peers = 6, .loss = 0.05, .seed = 2});
  const auto group = w.build_group(managed_kitchen());
  w.subscribe(1, group, "light");
  w.subscribe(6, group, "light");
  w.subscribe(5, group, "heat");
  w.subscribe(2, group, "light", 0, std::nullopt, false); // does not wait
  w.run_for(5s);
  for (std::uint8_t i = 0; i < 50; ++i) {
    w.raise(3, group, "light", {i});
    w.run_for(1s);
  }
  for (const std::size_t i : {1, 6}) {
    const auto got = w.signals<receive_result>(i);
    REQUIRE(got.size() == 50);
    for (std::uint8_t k = 0; k < 50; ++k)
      CHECK(got[k] == receive_result{mote_id{3}, group, "light", {k}});
  }
  CHECK(w.signals<receive_result>(5).empty());
  CHECK(w.signals<receive_result>(2).empty());
  CHECK(w.at(2).events().counters().dropped.at("not_waited_for") == 50);
  w.with(2, [&](peer& each, instant t, outputs& out) {
    return each.smepp_receive(group, "light", 0, t, out);
  });
  w.raise(3, group, "light", {99});
  w.run_for(1s);
  CHECK(w.signals<receive_result>(2).size() == 1);
}

TEST_CASE("who joins later is notified of what is subscribed", "[smepp][SMP-10]") {
  world w({.peers = 4});
  const auto group = std::get<group_id>(w.with(1, [&](peer& each, instant t, outputs& out) {
    return each.smepp_createGroup(managed_kitchen(), t, out);
  }));
  w.subscribe(1, group, "light");
  w.subscribe(1, group, "heat", 2);
  for (std::size_t i = 2; i <= 4; ++i) {
    CHECK(w.join(i, group, std::nullopt, {}) == std::nullopt);
    CHECK(w.signals<joinGroup_result>(i).at(0).subscriptions.size() == 2);
    CHECK(w.signals<subscribed>(i).size() == 2);
  }
  w.raise(4, group, "light"); // no new round was needed
  w.run_for(1s);
  CHECK(w.signals<receive_result>(1).size() == 1);
}

TEST_CASE("an unsubscription stops events and frees the radio", "[smepp][SMP-21]") {
  world w({.peers = 3});
  const auto group = w.build_group(managed_kitchen(2s));
  w.run_for(60s);
  const auto share = [&](std::size_t i) {
    const auto before = w.radio_time(i);
    w.run_for(5min);
    return seconds(w.radio_time(i) - before) / 300;
  };
  const auto idle = share(2);
  w.subscribe(1, group, "light", 2);
  w.subscribe(1, group, "heat", 0.5);
  w.run_for(10s);
  CHECK(share(2) > idle + 0.1);
  const auto unsubscribe = [&](const std::string& name) {
    return w.with(1, [&](peer& each, instant t, outputs& out) {
      return each.smepp_unsubscribe(name, group, t, out);
    });
  };
  CHECK(unsubscribe("light") == std::nullopt);
  CHECK(unsubscribe("light") == failure::bad_argument);
  w.run_for(10s);
  CHECK(depths(w).size() == 3);
  CHECK(unsubscribe("") == std::nullopt); // all
  w.run_for(10s);
  CHECK(depths(w).empty());
  CHECK(w.signals<unsubscribed>(3).size() == 2);
  CHECK(share(2) < idle + 0.01);
  w.raise(3, group, "light");
  w.run_for(10s);
  CHECK(w.signals<receive_result>(1).empty());
}

TEST_CASE("tables are bounded and say so", "[smepp][SMP-22][SMP-30]") {
  world w({.peers = 2});
  const auto group = w.build_group(managed_kitchen());
  for (char c = 'a'; c < 'i'; ++c)
    CHECK(w.subscribe(1, group, {c}) == std::nullopt);
  CHECK(w.subscribe(1, group, "one more") == failure::no_room);
  w.run_for(10s);
  CHECK(w.subscribe(2, group, "mine") == failure::no_room);
  CHECK(w.subscribe(2, group, "") == failure::bad_argument);
  CHECK(w.subscribe(2, group, std::string(33, 'x')) == failure::bad_argument);
  CHECK(w.subscribe(2, group, "x", -1) == failure::bad_argument);
  CHECK(w.raise(2, group, "a", bytes(65, 0)) == failure::bad_argument);
  w.power_off(1);
  for (int i = 0; i < 12; ++i)
    w.raise(2, group, "a");
  CHECK(w.at(2).events().counters().dropped.at("queue_full") == 4);
  w.run_for(2min);
  CHECK(w.at(2).events().counters().dropped.at("gave_up") == 8);
}

TEST_CASE("an event finds another route when a parent is gone", "[smepp][SMP-18][SMP-22]") {
  world w({.peers = 9, .columns = 3});
  const auto group = w.build_group(managed_kitchen());
  w.subscribe(1, group, "light");
  w.run_for(35s);
  const auto parent = w.at(9).events().all().at(0).parent;
  REQUIRE(w.at(9).events().all().at(0).other_parent != no_mote);
  w.power_off(parent.value); // silently
  w.raise(9, group, "light");
  w.run_for(2s);
  CHECK(w.signals<receive_result>(1).size() == 1); // before any refresh
  w.run_for(40s);
  CHECK(w.at(9).events().all().at(0).parent != parent);
}

TEST_CASE("the same things happen with the energy module on and off", "[smepp][SMP-27]") {
  std::vector<std::size_t> got;
  std::vector<double> shares;
  for (const bool saves : {true, false}) {
    world w({.peers = 4, .loss = 0.05, .seed = 6}, [&](peer_config& x) { x.saves_energy = saves; });
    const auto group = w.build_group(managed_kitchen(2s));
    w.subscribe(1, group, "light", 0.2);
    w.run_for(60s);
    const auto before = w.radio_time(2);
    for (int i = 0; i < 60; ++i) {
      w.raise(4, group, "light");
      w.run_for(5s);
    }
    got.push_back(w.signals<receive_result>(1).size());
    shares.push_back(seconds(w.radio_time(2) - before) / 300);
  }
  CHECK(got == std::vector<std::size_t>{60, 60});
  CHECK(shares[0] < 0.15);
  CHECK(shares[1] > 0.999);
}

TEST_CASE("a subscriber may wake more seldom than events are made", "[smepp][SMP-20]") {
  world w({.peers = 2});
  const auto group = w.build_group(managed_kitchen(10s));
  w.subscribe(1, group, "light", 2);
  w.run_for(60s);
  const auto share = [&] {
    const auto before = w.radio_time(1);
    w.run_for(60s);
    return seconds(w.radio_time(1) - before) / 60;
  };
  const auto often = share();
  w.with(1, [&](peer& each, instant t, outputs& out) {
    return each.smepp_receive(group, "light", 0.5, t, out);
  });
  CHECK(share() < often / 2);
  w.raise(2, group, "light");
  w.run_for(12s);
  CHECK(w.signals<receive_result>(1).size() == 1);
}
