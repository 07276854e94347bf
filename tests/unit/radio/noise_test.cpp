#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "radio/medium/noise.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::radio;

namespace {

using readings = std::vector<std::int8_t>;

/// A quiet floor, with bursts of some 12 readings 30 dB above it.
readings bursts(std::size_t count) {
  random_stream rng(5);
  readings all;
  bool is_burst = false;
  while (all.size() < count) {
    if (rng.chance(is_burst ? 1.0 / 12 : 1.0 / 150))
      is_burst = !is_burst;
    const auto dbm = (is_burst ? -68 : -98) + static_cast<int>(rng.below(3)) - 1;
    all.push_back(static_cast<std::int8_t>(dbm));
  }
  return all;
}

std::shared_ptr<const noise_trace> traced(readings x) {
  return std::make_shared<const noise_trace>(std::move(x));
}

readings generated(std::shared_ptr<const noise_trace> trace, std::uint64_t seed, int count) {
  noise_source source(std::move(trace), random_stream(seed));
  readings all;
  for (int i = 0; i < count; ++i)
    all.push_back(source.at(instant{} + i * 1ms));
  return all;
}

double mean(const readings& all) {
  double sum = 0;
  for (const auto x : all)
    sum += x;
  return sum / static_cast<double>(all.size());
}

double autocorrelation(const readings& all, std::size_t lag) {
  const auto middle = mean(all);
  double with = 0;
  double itself = 0;
  for (std::size_t i = lag; i < all.size(); ++i) {
    with += (all[i] - middle) * (all[i - lag] - middle);
    itself += (all[i] - middle) * (all[i] - middle);
  }
  return with / itself;
}

} // namespace

TEST_CASE("generated noise is distributed as the recorded is", "[radio][noise]") {
  const auto recorded = bursts(50000);
  const auto made = generated(traced(recorded), 1, 400000);
  CHECK(std::abs(mean(made) - mean(recorded)) < 0.5);
  std::map<std::int8_t, double> shares;
  for (const auto x : recorded)
    shares[x] += 1.0 / static_cast<double>(recorded.size());
  for (const auto x : made) {
    REQUIRE(shares.count(x) == 1); // nothing that was never recorded
    shares[x] -= 1.0 / static_cast<double>(made.size());
  }
  for (const auto& [dbm, difference] : shares)
    CHECK(std::abs(difference) < 0.015);
}

TEST_CASE("generated noise hangs together as the recorded does", "[radio][noise]") {
  const auto recorded = bursts(50000);
  const auto made = generated(traced(recorded), 2, 400000);
  CHECK(autocorrelation(recorded, 1) > 0.8);
  CHECK(std::abs(autocorrelation(made, 1) - autocorrelation(recorded, 1)) < 0.02);
  CHECK(std::abs(autocorrelation(made, 10) - autocorrelation(recorded, 10)) < 0.05);
}

TEST_CASE("a pattern that occurs once has one continuation", "[radio][noise]") {
  readings ramp; // 23 levels of 5 dB up and down: every pattern of a period is met once in it
  for (int period = 0; period < 4; ++period) {
    for (int level = 0; level < 22; ++level)
      ramp.push_back(static_cast<std::int8_t>(-115 + 5 * level));
    for (int level = 22; level > 0; --level)
      ramp.push_back(static_cast<std::int8_t>(-115 + 5 * level));
  }
  const auto made = generated(traced(ramp), 3, 500);
  for (std::size_t i = 44; i < made.size(); ++i)
    CHECK(made[i] == made[i - 44]);
}

TEST_CASE("what follows a pattern is drawn as often as it did", "[radio][noise]") {
  readings all; // 19 quiet readings, then loud with a chance of a quarter
  for (int i = 0; i < 400; ++i) {
    all.insert(all.end(), 19, -98);
    all.push_back(i % 4 == 0 ? -50 : -70);
    all.push_back(-90);
  }
  const auto made = generated(traced(all), 4, 210000);
  int louder = 0;
  int loud = 0;
  for (const auto x : made) {
    louder += x == -50 ? 1 : 0;
    loud += x == -70 ? 1 : 0;
  }
  CHECK(louder + loud == Approx(10000).margin(2));
  CHECK(louder == Approx(2500).margin(300));
}

TEST_CASE("after a pattern never met the commonest one counts", "[radio][noise]") {
  readings all(200, -98); // ends with something new: nothing follows its last pattern
  all.push_back(-40);
  all.push_back(-30);
  const auto made = generated(traced(all), 5, 20000);
  int ends = 0;
  for (std::size_t i = 1; i + 1 < made.size(); ++i) {
    if (made[i] != -30)
      continue;
    ++ends;
    CHECK(made[i - 1] == -40);
    CHECK((made[i + 1] == -98 || made[i + 1] == -40)); // what follows the quiet pattern
  }
  CHECK(ends > 50);
}

TEST_CASE("readings within 5 dB are one pattern, and all outside -115 to -5", "[radio][noise]") {
  readings all;
  random_stream rng(8);
  for (int i = 0; i < 2000; ++i) { // -100..-96 are one level, so is everything from -5 up
    const auto quiet = static_cast<std::int8_t>(-100 + static_cast<int>(rng.below(5)));
    const auto loud = static_cast<std::int8_t>(-5 + static_cast<int>(rng.below(132)));
    all.push_back(i % 2 == 0 ? quiet : loud);
  }
  const auto one = generated(traced(all), 6, 5000);
  const auto another = generated(traced(all), 7, 5000);
  int same = 0;
  for (std::size_t i = 0; i < one.size(); ++i)
    same += one[i] == another[i] ? 1 : 0;
  CHECK(same < 1000); // would they be patterns of their own, the trace would just be replayed
  for (std::size_t i = 1; i < one.size(); ++i)
    CHECK((one[i] >= -5) != (one[i - 1] >= -5));
}

TEST_CASE("the same rng make the same noise, others another", "[radio][noise]") {
  const auto trace = traced(bursts(5000));
  CHECK(generated(trace, 9, 3000) == generated(trace, 9, 3000));
  CHECK(generated(trace, 9, 3000) != generated(trace, 10, 3000));
}

TEST_CASE("a reading lasts for its millisecond", "[radio][noise]") {
  const auto trace = traced(bursts(5000));
  noise_source often(trace, random_stream(11));
  noise_source once(trace, random_stream(11));
  for (int i = 0; i < 1000; ++i) {
    const auto start = instant{} + i * 1ms;
    const auto reading = often.at(start);
    CHECK(often.at(start + 500us) == reading);
    CHECK(often.at(start + 999999ns) == reading);
    CHECK(once.at(start) == reading);
  }
}

TEST_CASE("readings not asked for are made all the same, up to a second", "[radio][noise]") {
  const auto trace = traced(bursts(5000));
  const auto all = generated(trace, 12, 1101);
  noise_source source(trace, random_stream(12));
  CHECK(source.at(instant{}) == all[0]);
  CHECK(source.at(instant{} + 100ms) == all[100]);
  CHECK(source.at(instant{} + 1100ms) == all[1100]); // exactly noise_source::memory
}

TEST_CASE("after more than a second the chain starts again anywhere", "[radio][noise]") {
  const auto trace = traced(bursts(5000));
  int differ = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    noise_source late(trace, random_stream(seed));
    noise_source later(trace, random_stream(seed));
    CHECK(late.at(instant{}) == later.at(instant{}));
    const auto again = late.at(instant{} + 1001ms);
    CHECK(again == later.at(instant{} + 10h)); // nothing was made in between
    differ += again != generated(trace, seed, 1002).back() ? 1 : 0;
  }
  CHECK(differ > 20);
}

TEST_CASE("where a chain starts is anywhere in the trace", "[radio][noise]") {
  readings all;
  for (int i = 0; i < 1000; ++i)
    all.push_back(static_cast<std::int8_t>(i < 500 ? -98 : -60));
  const auto trace = traced(all);
  int quiet = 0;
  for (std::uint64_t seed = 0; seed < 1000; ++seed)
    quiet += noise_source(trace, random_stream(seed)).at(instant{} + 3s) == -98 ? 1 : 0;
  CHECK(quiet == Approx(490).margin(60)); // 480 of 980 places have a history before them
}

TEST_CASE("the shortest trace will do", "[radio][noise]") {
  const auto made = generated(traced(readings(noise_trace::readings_min, -128)), 14, 1000);
  CHECK(made == readings(1000, -128));
}
