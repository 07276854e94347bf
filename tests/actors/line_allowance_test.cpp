#include "actors/base/line_allowance.hpp"
#include "support/catch.hpp"

using namespace rubicon;

TEST_CASE("lines that others bring about are few, and those left out are counted",
          "[actors][log]") {
  line_allowance lines;
  const instant start{1h};
  for (unsigned i = 0; i < line_allowance::lines_max; ++i)
    CHECK(lines.ask(start + i * 1ms) == 0);
  for (int i = 0; i < 1000; ++i)
    CHECK_FALSE(lines.ask(start + line_allowance::period - 1ns));
  CHECK(lines.ask(start + line_allowance::period) == 1000);
  CHECK(lines.ask(start + line_allowance::period) == 0);
}

TEST_CASE("lines that are rare are all written", "[actors][log]") {
  line_allowance lines;
  for (int i = 0; i < 100; ++i)
    CHECK(lines.ask(instant{i * 1s}) == 0);
}
