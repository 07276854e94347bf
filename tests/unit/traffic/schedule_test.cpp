#include <algorithm>
#include <set>
#include <vector>

#include "support/catch.hpp"
#include "traffic/schedule.hpp"

using namespace rubicon;
using namespace rubicon::traffic;

namespace {

sender_config sender(arrivals pattern, duration every) {
  sender_config x;
  x.pattern = pattern;
  x.every = every;
  return x;
}

/// When a schedule that starts at `boot` makes requests, at most `count` of them.
std::vector<instant> requests(const sender_config& config, std::uint64_t seed, std::size_t count,
                              instant boot = {}) {
  schedule x(config, random_stream(seed));
  x.start(boot);
  std::vector<instant> made;
  while (made.size() < count && x.due()) {
    made.push_back(*x.due());
    x.on_request(*x.due());
  }
  return made;
}

} // namespace

TEST_CASE("a periodic sender asks every period from its start", "[traffic]") {
  auto config = sender(arrivals::periodic, 100ms);
  config.start = 2s;
  CHECK(requests(config, 1, 4) ==
        std::vector{instant(2s), instant(2100ms), instant(2200ms), instant(2300ms)});
}

TEST_CASE("jitter moves each request of a periodic sender by itself", "[traffic]") {
  auto config = sender(arrivals::periodic, 100ms);
  config.start = 1s;
  config.jitter = 40ms;
  const auto made = requests(config, 7, 500);
  REQUIRE(made.size() == 500);
  auto least = 100ms + 0ns;
  auto most = 0ns;
  for (std::size_t k = 0; k < made.size(); ++k) {
    const auto late = made[k] - instant(1s + static_cast<duration::rep>(k) * 100ms);
    CHECK(late >= 0ns);
    CHECK(late < 40ms);
    least = std::min(least, late);
    most = std::max(most, late);
  }
  CHECK(least < 1ms);
  CHECK(most > 39ms);
}

TEST_CASE("a sender without a start begins at a random moment of its first period", "[traffic]") {
  const auto pattern = GENERATE(arrivals::periodic, arrivals::poisson);
  const auto config = sender(pattern, 10s);
  std::vector<instant> firsts;
  for (std::uint64_t seed = 0; seed < 100; ++seed)
    firsts.push_back(requests(config, seed, 1, instant(5s)).at(0));
  const auto [first, last] = std::ranges::minmax(firsts);
  CHECK(first >= instant(5s));
  CHECK(first < instant(6s));
  CHECK(last < instant(15s));
  CHECK(last > instant(14s));
}

TEST_CASE("a periodic sender that boots late keeps to the grid of its start", "[traffic]") {
  auto config = sender(arrivals::periodic, 100ms);
  config.start = 1s;
  CHECK(requests(config, 1, 1, instant(1s)).at(0) == instant(1s));
  CHECK(requests(config, 1, 1, instant(1s + 1ns)).at(0) == instant(1100ms));
  CHECK(requests(config, 1, 2, instant(1250ms)) == std::vector{instant(1300ms), instant(1400ms)});
  CHECK(requests(config, 1, 1, instant(1300ms)).at(0) == instant(1300ms));
}

TEST_CASE("a Poisson sender begins at its start, or a random gap after a late boot", "[traffic]") {
  auto config = sender(arrivals::poisson, 100ms);
  config.start = 1s;
  CHECK(requests(config, 1, 1).at(0) == instant(1s));
  CHECK(requests(config, 1, 1, instant(1s)).at(0) == instant(1s));
  CHECK(requests(config, 1, 1, instant(2s)).at(0) > instant(2s));
  CHECK(requests(config, 1, 1, instant(2s)) != requests(config, 2, 1, instant(2s)));
}

TEST_CASE("the gaps of a Poisson sender are exponential", "[traffic]") {
  auto config = sender(arrivals::poisson, 100ms);
  config.start = 0s;
  constexpr std::size_t count = 20'000;
  const auto made = requests(config, 3, count + 1);
  double sum_s = 0;
  double squares = 0;
  std::size_t above_mean = 0;
  for (std::size_t i = 1; i < made.size(); ++i) {
    REQUIRE(made[i] >= made[i - 1]);
    const auto gap_s = seconds(made[i] - made[i - 1]);
    sum_s += gap_s;
    squares += gap_s * gap_s;
    above_mean += gap_s > 0.1 ? 1 : 0;
  }
  const auto mean_s = sum_s / count;
  CHECK(mean_s == Approx(0.1).epsilon(0.03));
  CHECK(squares / count - mean_s * mean_s == Approx(0.01).epsilon(0.08)); // variance: mean squared
  CHECK(static_cast<double>(above_mean) / count == Approx(0.36788).margin(0.015)); // 1 / e
}

TEST_CASE("a saturated sender asks again when its request has ended", "[traffic]") {
  schedule x(sender(arrivals::saturated, 1s), random_stream(1));
  x.start(instant(3s));
  const auto first = x.due().value();
  x.on_request(first);
  CHECK(!x.due());
  x.on_answer(first, first + 1ns);
  CHECK(x.due() == first + 1ns);
}

TEST_CASE("a saturated sender begins at its start", "[traffic]") {
  auto config = sender(arrivals::saturated, 1s);
  config.start = 4s;
  CHECK(requests(config, 1, 1).at(0) >= instant(4s));
  CHECK(requests(config, 1, 1).at(0) <= instant(4s + schedule::phase_max));
  CHECK(requests(config, 1, 1, instant(9s)).at(0) >= instant(9s));
}

TEST_CASE("saturated senders begin at random phases", "[traffic]") {
  auto config = sender(arrivals::saturated, 1s);
  if (GENERATE(false, true))
    config.start = 4s;
  constexpr int count = 1000;
  std::set<duration> phases; // of the 16 us of a symbol
  auto first = instant(24h);
  auto last = instant(0s);
  for (int seed = 1; seed <= count; ++seed) {
    const auto begins = requests(config, static_cast<std::uint64_t>(seed), 1).at(0);
    phases.insert(begins.time_since_epoch() % duration(16us));
    first = std::min(first, begins);
    last = std::max(last, begins);
  }
  CHECK(phases.size() > count * 9 / 10);
  CHECK(last - first > schedule::phase_max * 9 / 10);
  CHECK(last - first <= schedule::phase_max);
}

TEST_CASE("a saturated sender whose request ends on the spot waits a millisecond", "[traffic]") {
  schedule x(sender(arrivals::saturated, 1s), random_stream(1));
  x.start(instant(3s));
  const auto first = x.due().value();
  x.on_request(first);
  x.on_answer(first, first);
  CHECK(x.due() == first + 1ms);
}

TEST_CASE("nothing is sent at or after the stop", "[traffic]") {
  auto config = sender(arrivals::periodic, 100ms);
  config.start = 0s;
  config.stop = 300ms;
  CHECK(requests(config, 1, 10) == std::vector{instant(0ms), instant(100ms), instant(200ms)});
  config.stop = 301ms;
  CHECK(requests(config, 1, 10).size() == 4);
  config.start = 301ms;
  CHECK(requests(config, 1, 10).empty());

  config = sender(arrivals::saturated, 1s);
  config.stop = 1s;
  schedule x(config, random_stream(1));
  x.start(instant(0s));
  x.on_request(x.due().value());
  x.on_answer(instant(0s), instant(1s - 1ns));
  CHECK(x.due() == instant(1s - 1ns));
  x.on_time(instant(1s)); // woken late
  CHECK(!x.due());
  x.on_answer(instant(0s), instant(1s));
  CHECK(!x.due());
}

TEST_CASE("a sender makes no more requests than its count", "[traffic]") {
  auto config = sender(GENERATE(arrivals::periodic, arrivals::poisson), 100ms);
  config.count = 3;
  CHECK(requests(config, 1, 10).size() == 3);
  config.count = 0;
  CHECK(requests(config, 1, 10).empty());

  config = sender(arrivals::saturated, 1s);
  config.count = 1;
  schedule x(config, random_stream(1));
  x.start(instant(0s));
  x.on_request(x.due().value());
  x.on_answer(instant(0s), instant(15ms));
  CHECK(!x.due());
}

TEST_CASE("a sender is active from its first request to the end of sending", "[traffic]") {
  auto config = sender(arrivals::periodic, 100ms);
  config.start = 1s;
  schedule x(config, random_stream(1));
  const auto active = [&](duration now) {
    const auto span = x.active(instant(now));
    return span ? std::optional(span->until - span->from) : std::nullopt;
  };
  x.start(instant(0s));
  CHECK(!active(2s));
  x.on_request(instant(1s));
  CHECK(active(1s) == 0s);
  CHECK(active(1050ms) == 50ms);
  x.end(instant(1060ms)); // power lost
  CHECK(active(5s) == 60ms);

  config.count = 2; // two packets in two periods
  x = schedule(config, random_stream(1));
  x.start(instant(0s));
  x.on_request(instant(1s));
  x.on_request(instant(1100ms));
  CHECK(active(1150ms) == 150ms);
  CHECK(active(5s) == 200ms);

  config.count.reset();
  config.stop = 1070ms;
  x = schedule(config, random_stream(1));
  x.start(instant(0s));
  x.on_request(instant(1s));
  CHECK(active(1050ms) == 50ms);
  CHECK(active(5s) == 70ms);

  config = sender(arrivals::saturated, 1s);
  config.stop = 2s;
  x = schedule(config, random_stream(1));
  x.start(instant(0s));
  const auto first = x.due().value().time_since_epoch();
  x.on_request(instant(first));
  CHECK(active(1s) == 1s - first);
  CHECK(active(3s) == 2s - first);
}

TEST_CASE("times near the end of time do not overflow", "[traffic]") {
  auto config = sender(GENERATE(arrivals::periodic, arrivals::poisson), duration::max());
  config.jitter = duration::max();
  const auto made = requests(config, 1, 5, instant(1s));
  CHECK(std::ranges::is_sorted(made));
  CHECK(made.size() == 5);
  config.start = 1s;
  const auto late = requests(config, 1, 5, instant(2s));
  CHECK(std::ranges::is_sorted(late));
}
