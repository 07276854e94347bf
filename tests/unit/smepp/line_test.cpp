// Groups over many hops and hours: losses, crystals, reboots, members that vanish, partitions.
#include <numeric>

#include "support/catch.hpp"
#include "unit/smepp/world.hpp"

using namespace rubicon;
using namespace rubicon::smepp;
using namespace rubicon::smepp::test;

namespace {

constexpr std::uint64_t seeds = 20;

group_description meadow() {
  return {.name = "meadow", .master = key_of(9), .is_closed = true, .management = {2s, 100ms}};
}

std::vector<std::size_t> peers(std::size_t from, std::size_t to) {
  std::vector<std::size_t> all(to - from + 1);
  std::iota(all.begin(), all.end(), from);
  return all;
}

/// The largest difference between the group's time at two of them.
std::chrono::microseconds spread(world& w, group_id group, const std::vector<std::size_t>& who) {
  auto first = group_time_max;
  group_time last{};
  for (const auto i : who) {
    const auto at = w.at(i).groups().find(group)->sync.at(w.local(i));
    first = std::min(first, at);
    last = std::max(last, at);
  }
  return last - first;
}

/// Events from one to another, one each `pause`. @returns how many have come
std::size_t deliver(world& w, group_id group, std::size_t from, std::size_t to, int count,
                    duration pause) {
  const auto before = w.signals<receive_result>(to).size();
  for (int i = 0; i < count; ++i) {
    w.raise(from, group, "light", {static_cast<std::uint8_t>(i)});
    w.run_for(pause);
  }
  w.run_for(20s);
  return w.signals<receive_result>(to).size() - before;
}

world line(std::uint64_t seed, std::size_t peers = 9) {
  return world({.peers = peers, .loss = 0.05, .crystals_ppm = 100, .seed = seed});
}

} // namespace

TEST_CASE("a group of eight hops delivers while it sleeps",
          "[smepp][SMP-15][SMP-19][SMP-23][SMP-26]") {
  std::size_t raised = 0;
  std::size_t got = 0;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    auto w = line(seed);
    const auto group = w.build_group(meadow());
    INFO("seed " << seed);
    REQUIRE(w.agree(group, peers(1, 9)));
    w.run_for(5min);
    w.subscribe(1, group, "light", 0.1);
    w.run_for(60s);
    REQUIRE(w.at(9).events().all().size() == 1);
    CHECK(w.at(9).events().all()[0].depth == 8);
    const auto on_before = w.radio_time(5);
    const auto from = w.now();
    for (int part = 0; part < 5; ++part) {
      raised += 60;
      got += deliver(w, group, 9, 1, 60, 10s);
      CHECK(spread(w, group, peers(1, 9)) < energy_config{}.radio_delay); // SMP-26
    }
    CHECK(seconds(w.radio_time(5) - on_before) / seconds(w.now() - from) < 0.12);
  }
  INFO(got << " of " << raised);
  CHECK(static_cast<double>(got) >= 0.99 * static_cast<double>(raised));
}

TEST_CASE("members that lose their power come back", "[smepp][SMP-18][SMP-22]") {
  std::size_t raised = 0;
  std::size_t got = 0;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    auto w = line(100 + seed, 6);
    random_stream rng(seed);
    const auto group = w.build_group(meadow());
    INFO("seed " << seed);
    w.run_for(2min);
    w.subscribe(1, group, "light", 0.1);
    w.run_for(60s);
    for (int i = 0; i < 4; ++i) {
      const auto victim = 2 + rng.below(5);
      w.power_off(victim);
      w.run_for(rng.between(1s, 120s));
      if (i == 2) // the keys change without it
        w.with(1, [&](peer& each, instant t, outputs& out) {
          return each.refresh_session_keys(group, t, out);
        });
      w.run_for(rng.between(1s, 120s));
      w.power_on(victim);
      w.run_for(3min);
      CHECK(w.agree(group, peers(1, 6)));
      raised += 12;
      got += deliver(w, group, 6, 1, 12, 10s);
      CHECK(spread(w, group, peers(1, 6)) < energy_config{}.radio_delay);
    }
  }
  INFO(got << " of " << raised);
  CHECK(static_cast<double>(got) >= 0.99 * static_cast<double>(raised));
}

TEST_CASE("a group goes on without members that have vanished", "[smepp][SMP-18][SMP-22]") {
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    world w({.peers = 9, .columns = 3, .loss = 0.05, .crystals_ppm = 100, .seed = 200 + seed});
    random_stream rng(seed);
    const auto group = w.build_group(meadow());
    INFO("seed " << seed);
    REQUIRE(w.agree(group, peers(1, 9)));
    w.run_for(2min);
    w.subscribe(9, group, "light", 0.1);
    w.run_for(60s);
    w.power_off(5); // the middle,
    w.power_off(rng.chance(0.5) ? 2 : 6);
    w.run_for(80s);
    CHECK(deliver(w, group, 4, 9, 20, 10s) >= 19);
    w.power_off(1); // and the root of the time, who is the lowest member
    w.run_for(20min);
    CHECK(deliver(w, group, 4, 9, 20, 10s) >= 19);
    CHECK(spread(w, group, {4, 7, 8, 9}) < energy_config{}.radio_delay);
  }
}

TEST_CASE("parts of a group go on alone, and become one again", "[smepp][SMP-22]") {
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    auto w = line(300 + seed, 6);
    random_stream rng(seed);
    const auto group = w.build_group(meadow());
    INFO("seed " << seed);
    REQUIRE(w.agree(group, peers(1, 6)));
    w.run_for(5min);
    w.subscribe(1, group, "light", 0.1);
    w.subscribe(4, group, "light", 0.1);
    w.run_for(60s);
    w.cut([](std::size_t a, std::size_t b) { return (a <= 3) != (b <= 3); });
    w.run_for(2min);
    CHECK(deliver(w, group, 3, 1, 10, 10s) == 10);
    CHECK(deliver(w, group, 6, 4, 10, 10s) == 10);
    // Keys change in both parts, not equally often.
    for (const std::size_t i : {2, 5, 5})
      if (i == 2 || rng.chance(0.6)) {
        w.with(i, [&](peer& each, instant t, outputs& out) {
          return each.refresh_session_keys(group, t, out);
        });
        w.run_for(30s);
      }
    w.run_for(rng.between(0s, 40min));
    CHECK(w.agree(group, peers(1, 3)));
    CHECK(w.agree(group, peers(4, 6)));
    w.cut({});
    CHECK(w.run_until([&] { return w.agree(group, peers(1, 6)); }, 20min, 1s));
    w.run_for(3min);
    CHECK(spread(w, group, peers(1, 6)) < energy_config{}.radio_delay);
    CHECK(deliver(w, group, 6, 1, 10, 10s) >= 9);
  }
}

TEST_CASE("radios are on the less than the sum of subscriptions", "[smepp][SMP-29]") {
  // The reference experiment: s1 subscribes, s4 produces, s2 is looked at.
  std::vector<double> shares(5);
  std::size_t raised = 0;
  std::size_t got = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed)
    for (std::size_t count = 0; count < shares.size(); ++count) {
      auto w = line(400 + 10 * seed + count, 4);
      random_stream rng(seed);
      const auto group = w.build_group(meadow());
      w.run_for(2min);
      std::vector<duration> pauses;
      for (std::size_t i = 0; i < count; ++i) {
        const double rate = 0.2 + 0.8 * rng.unit();
        pauses.push_back(duration(static_cast<std::int64_t>(1e9 / rate)));
        w.subscribe(1, group, std::to_string(i), rate);
      }
      w.run_for(35s);
      const auto before = w.radio_time(2);
      const auto raised_before = w.at(4).events().counters().raised;
      std::vector<instant> next(count, w.now());
      for (const auto end = w.now() + 180s; w.now() < end;) {
        auto at = end;
        for (std::size_t i = 0; i < count; ++i)
          at = std::min(at, next[i]);
        w.run_for(at - w.now());
        for (std::size_t i = 0; i < count; ++i)
          if (next[i] <= w.now()) {
            w.raise(4, group, std::to_string(i));
            next[i] += pauses[i];
          }
      }
      shares[count] += seconds(w.radio_time(2) - before) / 180 / 10;
      w.run_for(20s);
      raised += w.at(4).events().counters().raised - raised_before;
      got += w.signals<receive_result>(1).size();
    }
  CAPTURE(shares[0], shares[1], shares[2], shares[3], shares[4], got, raised);
  CHECK(shares[0] <= 0.10); // of a radio that is always on
  CHECK(shares[4] <= 0.50);
  CHECK(shares[4] - shares[0] < 4 * (shares[1] - shares[0]));
  for (std::size_t i = 1; i < shares.size(); ++i)
    CHECK(shares[i] > shares[i - 1]);
  CHECK(static_cast<double>(got) >= 0.99 * static_cast<double>(raised));
}
