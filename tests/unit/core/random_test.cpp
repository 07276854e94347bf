#include <array>

#include "core/numbers/random.hpp"
#include "support/catch.hpp"

using namespace rubicon;

TEST_CASE("streams depend on seed and path alone", "[core][random][GEN-07]") {
  random_stream a(1, "kitchen/7");
  random_stream b(1, "kitchen/7");
  random_stream c(1, "kitchen/8");
  random_stream d(2, "kitchen/7");
  const auto first = a.next();
  CHECK(first == b.next());
  CHECK(first != c.next());
  CHECK(first != d.next());
}

TEST_CASE("uniform numbers fill their range evenly", "[core][random]") {
  random_stream rng(5);
  std::array<int, 10> counts{};
  for (int i = 0; i < 100'000; ++i)
    ++counts[rng.below(10)];
  for (const auto count : counts)
    CHECK(std::abs(count - 10'000) < 500); // 5 sigma
  for (int i = 0; i < 1000; ++i) {
    const auto x = rng.unit();
    CHECK(x >= 0);
    CHECK(x < 1);
    const auto t = rng.between(2s, 3s);
    CHECK(t >= 2s);
    CHECK(t < 3s);
  }
  CHECK(rng.between(2s, 2s) == 2s);
}

TEST_CASE("certainty and impossibility draw nothing", "[core][random]") {
  random_stream a(1);
  random_stream b(1);
  CHECK(a.chance(1));
  CHECK_FALSE(a.chance(0));
  CHECK(a.next() == b.next());
}

TEST_CASE("normal deviates have mean 0 and variance 1", "[core][random]") {
  random_stream rng(6);
  double sum = 0;
  double squares = 0;
  constexpr int n = 100'000;
  for (int i = 0; i < n; ++i) {
    const auto x = rng.normal();
    sum += x;
    squares += x * x;
  }
  CHECK(std::abs(sum / n) < 0.02);
  CHECK(squares / n == Approx(1).epsilon(0.02));
}

TEST_CASE("a reseeding changes what is drawn while it lives", "[core][random]") {
  const auto drawn = [](std::uint64_t key) {
    const reseeding anew({instant(5s), key});
    return random_stream(7).next();
  };
  random_stream a(7);
  random_stream b(7);
  CHECK(a.next() == b.next());
  std::uint64_t during = 0;
  {
    const reseeding anew({instant(5s), 1});
    CHECK(reseeding::current() == reseeding::settings{instant(5s), 1});
    during = a.next();
  }
  CHECK(during != b.next());
  CHECK(a.next() == b.next()); // where the streams are is the same
  CHECK(!reseeding::current());
  CHECK(drawn(1) == drawn(1));
  CHECK(drawn(1) != drawn(2));
  CHECK(drawn(0) != random_stream(7).next());
}

TEST_CASE("what is drawn anew is as even as before", "[core][random]") {
  const reseeding anew({instant(), 3});
  random_stream rng(5);
  std::array<int, 10> counts{};
  for (int i = 0; i < 100'000; ++i)
    ++counts[rng.below(10)];
  for (const auto count : counts)
    CHECK(std::abs(count - 10'000) < 500); // 5 sigma
}

TEST_CASE("the deviate of a seed is fixed", "[core][random]") {
  const auto x = random_stream(9).normal();
  CHECK(random_stream::fixed_normal(9) == x);
  const reseeding anew({instant(), 1});
  CHECK(random_stream::fixed_normal(9) == x);
  CHECK(random_stream(9).normal() != x);
}
