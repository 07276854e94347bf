#include <vector>

#include "network/clock/clock_sync.hpp"
#include "network/clock/time_search.hpp"
#include "support/catch.hpp"
#include "support/seeds.hpp"

namespace rubicon::network {

namespace {

using beacon_due = time_search::beacon_due;

time_search_config sleeping(duration period) {
  time_search_config x;
  x.duty.period = period;
  x.duty.length = 100ms;
  return x;
}

/// How long a radio is on for a search that finds nothing, and what it sends.
struct tally {
  duration on{};
  unsigned asks = 0;
  unsigned plain = 0;
  std::vector<instant> asked;
};

/// Of a mote that has known the time for long.
time_estimate known_clock() {
  clock_sync_config of_root;
  of_root.self = mote_id{1};
  of_root.is_root = true;
  clock_sync clock(of_root, instant{});
  clock.set_time(island_time(17s), instant(1h));
  return clock.time();
}

tally search_for(time_search& x, instant from, duration length, time_knowledge knowledge) {
  const auto clock = known_clock();
  tally sum;
  for (auto now = from; now < from + length; now += 10ms) {
    const auto due = x.on_time(now, knowledge, clock);
    if (due == beacon_due::ask) {
      ++sum.asks;
      sum.asked.push_back(now);
    }
    sum.plain += due == beacon_due::plain ? 1 : 0;
    if (x.listens(now) || !x.rests())
      sum.on += 10ms;
  }
  return sum;
}

time_search settled(const time_search_config& config, std::uint64_t seed, instant now) {
  time_search x(config, random_stream(seed), now);
  static_cast<void>(x.on_time(now, time_knowledge::good, known_clock()));
  return x;
}

} // namespace

TEST_CASE("a search asks in each window of a whole period", "[network][CLK-04]") {
  for (std::uint64_t seed = 1; seed <= test::seeds(20); ++seed) {
    const duration period = 4s;
    auto x = settled(sleeping(period), seed, instant(1h));
    const auto sum = search_for(x, instant(1h), 40s, time_knowledge::stale);
    REQUIRE(sum.asked.size() > 40);
    CHECK(sum.asked.front() - instant(1h) <= 10s + period);
    for (std::size_t i = 0; i < 2; ++i) { // in its own windows first
      const auto time = known_clock().at(sum.asked[i]).time_since_epoch();
      CHECK(time % period <= std::chrono::microseconds(60'000));
    }
    const auto first = sum.asked[2];
    // Whatever the neighbours' windows are: one lies within the search, and has a beacon in it.
    for (duration phase{}; phase < period; phase += 50ms) {
      const auto in_window = [&](instant t) {
        const auto into = (t.time_since_epoch() - phase) % period;
        return t < first + period + 100ms && into >= 0s && into < 100ms;
      };
      CHECK(std::ranges::any_of(sum.asked, in_window));
    }
  }
}

TEST_CASE("who distrusts its time asks at once", "[network][CLK-04]") {
  auto x = settled(sleeping(30s), 1, instant(1h));
  const auto sum = search_for(x, instant(1h), 1s, time_knowledge::doubted);
  REQUIRE(sum.asks > 0);
  CHECK(sum.asked.front() - instant(1h) <= 50ms);
}

TEST_CASE("a search ends with what it looks for", "[network][CLK-04]") {
  auto x = settled(sleeping(4s), 1, instant(1h));
  static_cast<void>(search_for(x, instant(1h), 16s, time_knowledge::stale));
  CHECK(x.is_lost());
  CHECK(x.on_time(instant(1h) + 16s, time_knowledge::good, known_clock()) == beacon_due::none);
  CHECK_FALSE(x.is_lost());
  CHECK_FALSE(x.listens(instant(1h) + 16s));
  CHECK_FALSE(x.deadline());
}

TEST_CASE("a root that is away for a day flattens no battery, and is found within a minute",
          "[network][CLK-04][NRG-01]") {
  for (const duration period : {1s, 4s, 30s}) {
    for (std::uint64_t seed = 1; seed <= test::seeds(5); ++seed) {
      CAPTURE(seconds(period), seed);
      auto x = settled(sleeping(period), seed, instant{});
      const auto sum = search_for(x, instant{}, 24h, time_knowledge::none);
      CHECK(seconds(sum.on) < seconds(24h) * 0.015);
      for (std::size_t i = 1; i < sum.asked.size(); ++i)
        REQUIRE(sum.asked[i] - sum.asked[i - 1] <= 46s); // it is always on, and answers a probe
    }
  }
}

TEST_CASE("whoever has found another time stays on for the others, and calls them",
          "[network][CLK-04]") {
  const auto clock = known_clock();
  auto x = settled(sleeping(4s), 3, instant(1h));
  x.on_news(std::chrono::microseconds(1'300'000), clock, instant(1h));
  std::vector<instant> sent;
  for (auto now = instant(1h); now < instant(1h) + 5min; now += 5ms) {
    if (x.on_time(now, time_knowledge::good, known_clock()) == beacon_due::plain)
      sent.push_back(now);
    CHECK(x.listens(now) == (now < instant(1h) + 188s));
  }
  REQUIRE(sent.size() == 2);
  for (const auto each : sent) { // in the windows of the time before
    const auto before = clock.at(each) - std::chrono::microseconds(1'300'000);
    CHECK(before.time_since_epoch() % 4s >= std::chrono::microseconds(25'000));
    CHECK(before.time_since_epoch() % 4s <= std::chrono::microseconds(56'000));
  }
}

TEST_CASE("whoever finds its root after a long search stays on for the others",
          "[network][CLK-04]") {
  auto x = settled(sleeping(30s), 3, instant(1h));
  static_cast<void>(search_for(x, instant(1h), 10min, time_knowledge::stale));
  auto now = instant(1h) + 10min;
  for (; !x.rests(); now += 10ms)
    static_cast<void>(x.on_time(now, time_knowledge::stale, known_clock()));
  x.on_news(std::nullopt, known_clock(), now);
  CHECK(x.on_time(now, time_knowledge::good, known_clock()) == beacon_due::none);
  CHECK(x.listens(now + 239s)); // each of them sends four probes in this time
  CHECK_FALSE(x.listens(now + 241s));
}

TEST_CASE("whoever finds its root in a later search stays on as well", "[network][CLK-04]") {
  auto x = settled(sleeping(4s), 3, instant(1h));
  auto now = instant(1h);
  const auto go_on_while = [&x, &now](bool rests) {
    for (; x.rests() == rests; now += 10ms)
      static_cast<void>(x.on_time(now, time_knowledge::stale, known_clock()));
  };
  for (int searches = 0; searches < 6; ++searches) {
    go_on_while(false);
    go_on_while(true);
  }
  REQUIRE(now > instant(1h) + 2min); // the next search has just begun
  x.on_news(std::nullopt, known_clock(), now);
  CHECK(x.on_time(now, time_knowledge::good, known_clock()) == beacon_due::none);
  CHECK(x.listens(now + 187s));
  CHECK_FALSE(x.listens(now + 189s));
}

TEST_CASE("a root whose time begins anew calls for a whole period", "[network][CLK-04]") {
  auto config = sleeping(4s);
  config.is_root = true;
  auto x = settled(config, 1, instant(1h));
  x.announce(instant(1h));
  const auto sum = search_for(x, instant(1h), 10s, time_knowledge::good);
  CHECK(sum.plain >= 55);
  CHECK(sum.plain <= 64);
}

TEST_CASE("where radios are always on a search is a beacon now and then", "[network][CLK-04]") {
  auto x = settled({}, 1, instant{});
  const auto sum = search_for(x, instant{}, 24h, time_knowledge::stale);
  CHECK(sum.asks > 24h / 4min - 10);
  CHECK(sum.asks < 24h / 2min + 10);
}

TEST_CASE("of two that search near each other one asks", "[network][CLK-04]") {
  auto x = settled(sleeping(4s), 1, instant{});
  static_cast<void>(x.on_time(instant{}, time_knowledge::doubted, known_clock()));
  unsigned asks = 0;
  for (instant now; now < instant(4s); now += 10ms) {
    if (now.time_since_epoch() % 60ms == 0s)
      x.on_asked(now);
    asks += x.on_time(now, time_knowledge::doubted, known_clock()) == beacon_due::ask ? 1 : 0;
  }
  CHECK(asks <= 2);
}

} // namespace rubicon::network
