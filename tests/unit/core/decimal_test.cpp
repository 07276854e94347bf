#include <cstdint>
#include <vector>

#include "core/numbers/running_mean.hpp"
#include "core/text/decimal.hpp"
#include "support/catch.hpp"

using namespace rubicon;

TEST_CASE("a number is the whole text", "[core]") {
  CHECK(number_in("22.5") == 22.5);
  CHECK(number_in("-1e3") == -1000);
  for (const auto* text : {"", " 1", "1 ", "+1", "1C", "inf", "nan", "1e999", "0x1"}) {
    CAPTURE(text);
    CHECK(!number_in(text));
  }
}

TEST_CASE("a running mean is of the newest counts, rounded", "[core][PXY-17]") {
  running_mean aut(3);
  CHECK(aut.add(10) == 10);
  CHECK(aut.add(11) == 11); // 10.5
  CHECK(aut.add(12) == 11);
  CHECK(aut.add(20) == 14); // 14.33
  running_mean negative(2);
  CHECK(negative.add(-10) == -10);
  CHECK(negative.add(-11) == -11); // halves away from 0
  CHECK(negative.add(10) == -1);   // -0.5
  running_mean one;
  CHECK(one.add(32767) == 32767);
  CHECK(one.add(-32768) == -32768);
}
