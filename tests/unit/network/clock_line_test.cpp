#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "core/numbers/random.hpp"
#include "network/clock/clock_line.hpp"
#include "support/catch.hpp"
#include "support/seeds.hpp"

using namespace rubicon;
using network::clock_line;
using std::chrono::microseconds;

namespace {

/// By how much a clock is ahead of ours: its rate goes from one extreme to the other and back, each
/// in a straight line.
class other_clock {
public:
  explicit other_clock(random_stream& rng)
      : rate_(ppm(rng, 160)), wander_(rng.below(2) == 0 ? 0 : std::abs(ppm(rng, 20))),
        phase_s_(static_cast<double>(rng.below(600))) {}

  [[nodiscard]] double ahead_us(instant own) const {
    const auto t = seconds(own.time_since_epoch());
    return (rate_ * t + area(t + phase_s_) - area(phase_s_)) * 1e6;
  }

private:
  static double ppm(random_stream& rng, std::uint32_t most) {
    return (static_cast<double>(rng.below(2 * most + 1)) - most) * 1e-6;
  }

  /// Of a triangle between -wander and wander, once in ten minutes.
  [[nodiscard]] double area(double t) const {
    constexpr double half = 300;
    const auto into = std::fmod(t, 2 * half);
    const auto x = into < half ? into : into - half;
    return (into < half ? 1 : -1) * wander_ * x * (x / half - 1);
  }

  double rate_;
  double wander_;
  double phase_s_;
};

instant at(double s) {
  return instant(duration(static_cast<duration::rep>(s * 1e9)));
}

double error_us(const clock_line& x, const other_clock& of, instant own) {
  return std::abs(static_cast<double>(x.ahead_us(own)) - of.ahead_us(own));
}

} // namespace

TEST_CASE("a rate from two points is doubted as much as their noise may have turned it",
          "[network][CLK-01]") {
  clock_line x;
  x.restart(at(10), 4900, microseconds(4900)); // the other clock is not ahead at all
  x.add(at(16), -300, microseconds(300));
  CHECK(x.rate() == -clock_line::rate_max);
  for (const double s : {20, 30, 76}) {
    INFO(s << " s");
    CHECK(std::abs(x.ahead_us(at(s))) <= x.doubt(at(s)).count());
  }
}

TEST_CASE("a line that has missed a point has a rate in doubt", "[network][CLK-01]") {
  clock_line x;
  for (int i = 0; i <= 5; ++i)
    x.add(at(60 * i), 3000 * i, microseconds(50)); // 50 ppm
  REQUIRE(std::abs(x.rate() - 50e-6) < 1e-6);
  REQUIRE(x.doubt(at(310)) < microseconds(500));

  SECTION("by what the rate explains") {
    x.restart(at(360), 15000, microseconds(50)); // it has stood still
    CHECK(x.rate() == Approx(50e-6).margin(1e-6));
    CHECK(x.doubt(at(420)) >= microseconds(3000));
    x.add(at(420), 15000, microseconds(50));
    CHECK(x.doubt(at(430)) < microseconds(500));
  }
  SECTION("by no more than crystals can differ, however far the clock has leapt") {
    x.restart(at(360), 3'000'000'000, microseconds(50));
    CHECK(x.doubt(at(420)) > microseconds(12'000));
    CHECK(x.doubt(at(420)) < microseconds(16'000));
  }
}

TEST_CASE("a point counts for a line as much as it is sure", "[network][CLK-01]") {
  clock_line x;
  for (int i = 0; i <= 5; ++i)
    x.add(at(60 * i), 600 * i, microseconds(30)); // 10 ppm
  // The root is silent for ten minutes; others guess, each a little better than the one before.
  const std::int64_t right = 9000 + 900; // the rate has changed a little meanwhile
  x.add(at(880), right - 1600, microseconds(12'000));
  x.add(at(890), right - 1500, microseconds(6000));
  x.add(at(898), right - 1500, microseconds(3000));
  x.add(at(899), right - 1400, microseconds(1500));

  x.add(at(900), right, microseconds(30)); // a round of the root
  CHECK(std::abs(x.ahead_us(at(900)) - right) <= 30);
  CHECK(x.doubt(at(900)) <= microseconds(100));
  x.add(at(960), right + 720, microseconds(30)); // 12 ppm
  CHECK(std::abs(x.ahead_us(at(960)) - right - 720) <= 30);
  CHECK(std::abs(x.rate() - 12e-6) < 1.5e-6);
}

TEST_CASE("a better point takes the place of one that came just before it", "[network][CLK-01]") {
  clock_line x;
  x.add(at(0), 0, microseconds(30));
  x.add(at(60), 600, microseconds(30));
  for (int i = 0; i < 8; ++i) { // one round, from one neighbour after the other
    const auto noise = 16'384 >> (2 * i);
    x.add(at(120 + 0.6 * i), 1200 + 6 * i + (i % 2 == 0 ? noise / 2 : -noise / 2),
          microseconds(noise));
  }
  CHECK(std::abs(x.rate() - 10e-6) < 1e-6); // it still knows the points of long ago
}

TEST_CASE("a line is off by no more than its doubt", "[network][CLK-01]") {
  for (std::uint64_t seed = 1; seed <= test::seeds(3); ++seed) {
    random_stream rng(seed, "clock line");
    double outside_longest_us = 0;
    for (int run = 0; run < 20; ++run) {
      const other_clock truth(rng);
      const auto noise_max = std::uint32_t{30} + rng.below(5000);
      clock_line x;
      double t = 1;
      for (int i = 0; i < 100; ++i) {
        const auto noise = 15 + rng.below(noise_max);
        const auto read = truth.ahead_us(at(t)) + static_cast<double>(rng.below(2 * noise + 1)) -
                          static_cast<double>(noise);
        const auto ahead = static_cast<std::int64_t>(std::llround(read));
        const auto limit = x.empty() ? 0 : (x.doubt(at(t)) + microseconds(noise + 1)).count();
        if (x.empty() || std::abs(ahead - x.ahead_us(at(t))) > limit)
          x.restart(at(t), ahead, microseconds(noise));
        else if (microseconds(noise) <= x.doubt(at(t)))
          x.add(at(t), ahead, microseconds(noise));
        const auto gap = 1 + static_cast<double>(rng.below(60));
        for (const double share : {0.1, 0.5, 1.0}) {
          const auto now = at(t + share * gap);
          outside_longest_us =
              std::max(outside_longest_us,
                       error_us(x, truth, now) - static_cast<double>(x.doubt(now).count()));
        }
        t += gap;
      }
    }
    INFO("seed " << seed);
    CHECK(outside_longest_us < 1000);
  }
}
