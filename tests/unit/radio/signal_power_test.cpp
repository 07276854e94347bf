#include <cmath>
#include <limits>

#include "core/numbers/random.hpp"
#include "radio/medium/power.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::radio;

TEST_CASE("powers are whole units from -160 dBm up", "[radio][power]") {
  CHECK(to_units(-160) == 1);
  CHECK(to_units(-160.01) == 0);
  CHECK(to_units(-std::numeric_limits<double>::infinity()) == 0);
  CHECK(to_units(-150) == 10);
  CHECK(to_units(-157) == 2);
  CHECK(to_units(0) == static_cast<power_units>(1e16F));
  CHECK(to_units(30) == static_cast<power_units>(1e19F));
  CHECK(to_dbm(0) == -std::numeric_limits<double>::infinity());
  CHECK(to_dbm(1) == Approx(-160));
  CHECK(std::abs(to_dbm(10'000'000'000'000'000)) < 1e-12);
}

TEST_CASE("a power fits into a link's float without rounding", "[radio][power]") {
  random_stream rng(1);
  for (int i = 0; i < 10000; ++i) {
    const auto dbm = rng.unit() * 190 - 160;
    const auto x = to_units(dbm);
    CHECK(static_cast<power_units>(static_cast<float>(x)) == x);
    if (dbm > -95)
      CHECK(std::abs(to_dbm(x) - dbm) < 1e-6);
  }
}

TEST_CASE("powers grow with dBm", "[radio][power]") {
  power_units last = 0;
  for (double dbm = -165; dbm <= 30; dbm += 0.01) {
    CHECK(to_units(dbm) >= last);
    last = to_units(dbm);
  }
}

TEST_CASE("decibels and ratios turn into each other", "[radio][power]") {
  CHECK(from_db(0) == 1);
  CHECK(from_db(3) == Approx(1.9952623149688795));
  CHECK(from_db(-20) == Approx(0.01));
  CHECK(to_db(1) == 0);
  CHECK(to_db(1000) == Approx(30));
  for (double db = -200; db < 50; db += 0.7)
    CHECK(to_db(from_db(db)) == Approx(db).epsilon(1e-12));
}
