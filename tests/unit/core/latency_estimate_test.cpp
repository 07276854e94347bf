#include "core/numbers/latency_estimate.hpp"
#include "core/numbers/random.hpp"
#include "support/catch.hpp"

using namespace rubicon;

TEST_CASE("nothing is expected before the first answer", "[core][latency]") {
  latency_estimate x;
  CHECK_FALSE(x.bound());
  x.add(20ms);
  CHECK(x.bound() == 60ms); // RFC 6298 2.2
}

TEST_CASE("steady answers are expected to take what they take", "[core][latency]") {
  latency_estimate x;
  for (int i = 0; i < 100; ++i)
    x.add(20ms);
  CHECK(*x.bound() >= 20ms);
  CHECK(*x.bound() < 20100us);
}

TEST_CASE("few answers take longer than what is expected", "[core][latency]") {
  random_stream rng(7);
  latency_estimate x;
  x.add(2s);
  int longer = 0;
  for (int i = 0; i < 10'000; ++i) {
    const auto taken = rng.between(0s, 4s); // as over a hop whose radio wakes up every 4 s
    longer += taken > *x.bound() ? 1 : 0;
    x.add(taken);
  }
  CHECK(longer < 100);
}
