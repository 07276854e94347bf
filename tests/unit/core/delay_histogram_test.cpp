#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/numbers/delay_histogram.hpp"
#include "core/numbers/random.hpp"
#include "support/catch.hpp"

using namespace rubicon;

namespace {

/// Nearest rank. @pre `sorted` is not empty
double exact_quantile_ms(const std::vector<duration>& sorted, double q) {
  const auto rank = std::max(1.0, std::ceil(q * static_cast<double>(sorted.size())));
  return static_cast<double>(sorted[static_cast<std::size_t>(rank) - 1].count()) / 1e6;
}

/// From `from` to `to`, each order of magnitude as likely as the next.
duration any_magnitude(random_stream& rng) {
  const auto bits = rng.below(45);
  return duration(static_cast<duration::rep>(rng.below(std::uint64_t{2} << bits)));
}

} // namespace

TEST_CASE("a quantile is that of the nearest rank above", "[core]") {
  delay_histogram x;
  for (const int ns : {10, 20, 30}) // short enough to be exact
    x.add(duration(ns));
  CHECK(x.quantile_ms(0.5) == Approx(20e-6));
  CHECK(x.quantile_ms(0.34) == Approx(20e-6));
  CHECK(x.quantile_ms(0.33) == Approx(10e-6));
  CHECK(x.quantile_ms(1) == Approx(30e-6));
}

TEST_CASE("an empty histogram says 0", "[core]") {
  const delay_histogram x;
  CHECK(x.count() == 0);
  CHECK(x.mean_ms() == 0);
  CHECK(x.quantile_ms(0.5) == 0);
}

TEST_CASE("the quantiles of one delay are that delay", "[core]") {
  for (const auto delay : {0ns, 1ns, 63ns, 64ns, 127ns}) { // buckets of one nanosecond
    delay_histogram x;
    x.add(delay);
    for (const auto q : {0.0, 0.5, 1.0})
      CHECK(x.quantile_ms(q) == static_cast<double>(delay.count()) / 1e6);
  }
  for (const auto delay : {duration(128), duration(4256us), duration(1s), duration(24h)}) {
    delay_histogram x;
    x.add(delay);
    CHECK(x.mean_ms() == static_cast<double>(delay.count()) / 1e6);
    for (const auto q : {0.0, 0.5, 1.0})
      CHECK(x.quantile_ms(q) == Approx(x.mean_ms()).epsilon(0.008));
  }
}

TEST_CASE("a histogram takes the shortest and the longest time there is", "[core]") {
  delay_histogram x;
  x.add(-5ms);
  CHECK(x.quantile_ms(1) == 0);
  CHECK(x.mean_ms() == 0);
  x.add(duration::max());
  CHECK(x.quantile_ms(1) == Approx(9223372036854.775807).epsilon(0.008));
  CHECK(x.quantile_ms(0.5) == 0);
}

TEST_CASE("quantiles are within 0.8 % of those of the sorted delays", "[core]") {
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U}) {
    random_stream rng(seed);
    delay_histogram x;
    std::vector<duration> delays;
    double sum = 0;
    for (int i = 0; i < 2000; ++i) {
      delays.push_back(any_magnitude(rng));
      x.add(delays.back());
      sum += static_cast<double>(delays.back().count());
    }
    std::ranges::sort(delays);
    CHECK(x.count() == delays.size());
    CHECK(x.mean_ms() == Approx(sum / 2000 / 1e6).epsilon(1e-12));
    for (const auto q : {0.0, 0.001, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99, 1.0}) {
      INFO("seed " << seed << " q " << q);
      CHECK(x.quantile_ms(q) == Approx(exact_quantile_ms(delays, q)).epsilon(0.0079).margin(0));
    }
  }
}

TEST_CASE("histograms added up are the histogram of all their delays", "[core]") {
  random_stream rng(6);
  delay_histogram all;
  std::vector<delay_histogram> shares(3);
  for (std::uint64_t i = 0; i < 900; ++i) {
    const auto delay = rng.between(0s, 2s);
    all.add(delay);
    shares[i % 3].add(delay);
  }
  delay_histogram sum;
  for (const auto& x : shares)
    sum += x;
  CHECK(sum == all);
  sum += delay_histogram{};
  CHECK(sum == all);
  sum += sum;
  CHECK(sum.count() == 1800);
  CHECK(sum.quantile_ms(0.5) == all.quantile_ms(0.5));
}
