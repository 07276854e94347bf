#include <cmath>

#include "core/numbers/random.hpp"
#include "mote/crystal.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using mote::crystal;

TEST_CASE("a crystal gains or loses its parts per million", "[mote][CLK-01]") {
  CHECK(crystal().own(instant{1h}) == instant{1h});
  CHECK(crystal(40'000).own(instant{1000s}) == instant{1000s + 40ms});
  CHECK(crystal(-40'000).own(instant{1000s}) == instant{1000s - 40ms});
  CHECK(crystal(1).own(instant{1s}) == instant{1s + 1ns});
  CHECK(crystal(40'000).own(instant{24h * 365}) == instant{24h * 365 + 1'261'440ms});
}

TEST_CASE("a crystal never goes back, and real() is the first time that shows a moment",
          "[mote][CLK-01]") {
  const auto ppb = GENERATE(std::int64_t{0}, 1, -1, 40'000, -40'000, 1'000'000, -1'000'000);
  const crystal x(ppb);
  random_stream rng(static_cast<std::uint64_t>(ppb + 2'000'000));
  const auto check = [&x](instant t) {
    CHECK(x.own(t) <= x.own(t + 1ns));
    const auto real = x.real(t);
    CHECK(x.own(real) >= t);
    CHECK(x.own(real - 1ns) < t);
  };
  for (std::int64_t i = 0; i < 200; ++i)
    check(instant{1s - 100ns + i * 1ns}); // where whole seconds meet
  for (int i = 0; i < 1000; ++i)
    check(instant{duration(rng.below(1'000'000'000'000'000))});
}

TEST_CASE("real() is the first time that shows a moment, however the crystal wanders",
          "[mote][CLK-01]") {
  mote::crystal_config config;
  config.ppb = GENERATE(std::int64_t{0}, 40'000, -1'000'000);
  config.wander_ppb = GENERATE(std::int64_t{1}, 5'000, 100'000);
  config.wander_period = GENERATE(duration(10min), duration(24h));
  config.phase = config.wander_period / 3;
  const auto x = crystal(config).ahead_by(17min);
  random_stream rng(7);
  for (int i = 0; i < 500; ++i) {
    const instant moment{17min + rng.between(0s, 365 * 24h)};
    const auto real = x.real(moment);
    CHECK(x.own(real) >= moment);
    CHECK(x.own(real - 1ns) < moment);
  }
}

TEST_CASE("a crystal that wanders gains and loses with the temperature, and in the end nothing",
          "[mote][CLK-01]") {
  mote::crystal_config config;
  config.ppb = 20'000;
  config.wander_ppb = 5'000;
  config.wander_period = 24h;
  const crystal x(config);
  const auto rate = [&](duration at) { // ppm, over a minute
    const auto length = 1min;
    const auto shown = x.own(instant{} + at + length) - x.own(instant{} + at) - length;
    return static_cast<double>(shown.count()) / static_cast<double>(duration(length).count()) * 1e6;
  };
  CHECK(std::abs(rate(0s) - 15) < 0.1);
  CHECK(std::abs(rate(6h) - 20) < 0.1);
  CHECK(std::abs(rate(12h) - 25) < 0.1);
  CHECK(std::abs(rate(18h) - 20) < 0.1);
  CHECK(std::abs(rate(10 * 24h) - 15) < 0.1);
  const auto gained = x.own(instant{} + 24h) - (instant{} + 24h);
  CHECK(std::chrono::abs(gained - 1728ms) < 1us);
  config.phase = 6h;
  CHECK(crystal(config).own(instant{}) == instant{});
  const auto later = crystal(config).ahead_by(5min);
  CHECK(later.own(instant{}) == instant{} + 5min);
  auto last = later.own(instant{});
  for (auto real = instant{}; real < instant{} + 48h; real += 7min + 13us) {
    const auto own = later.own(real);
    CHECK(own >= last);
    CHECK(later.real(own) <= real);
    CHECK(later.own(later.real(own)) >= own);
    last = own;
  }
}
