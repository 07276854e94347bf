#include "core/numbers/report_schedule.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace std::chrono_literals;

TEST_CASE("reports that take no time are collected as often as was asked for", "[core]") {
  report_schedule x(5s);
  duration now = 17s;
  CHECK(x.is_due(now)); // the first at once
  for (int i = 0; i < 3; ++i) {
    REQUIRE(x.is_due(now));
    x.on_report(now, now + 20ms);
    CHECK_FALSE(x.is_due(now + 20ms));
    CHECK_FALSE(x.is_due(now + 5s - 1ns));
    now += 5s;
  }
}

TEST_CASE("after a report there is a pause of a hundred times as long", "[core]") {
  report_schedule x(5s);
  x.on_report(10s, 10s + 338ms); // 10,000 motes
  const auto due = 10s + 338ms + 100 * 338ms;
  CHECK_FALSE(x.is_due(due - 1ns));
  CHECK(x.is_due(due));
  x.on_report(due, due + 10ms); // cheap again: as often as was asked for
  CHECK_FALSE(x.is_due(due + 5s - 1ns));
  CHECK(x.is_due(due + 5s));
}

TEST_CASE("whatever reports cost, a run gives less than a hundredth of its time to them",
          "[core]") {
  for (const auto cost : {1us, 40ms + 0us, 51ms + 0us, 2s + 0us, 90s + 0us}) {
    CAPTURE(cost.count());
    report_schedule x(5s);
    duration spent{};
    constexpr duration length = 10h;
    for (duration now{}; now < length;) {
      if (!x.is_due(now)) {
        now += 250ms; // as a run looks
        continue;
      }
      x.on_report(now, now + cost);
      now += cost;
      spent += cost;
    }
    CHECK(spent > 0s);
    CHECK(spent - cost <= length / 100); // the first one had no pause before it
  }
}

TEST_CASE("a run that nobody wants a report of is never asked", "[core]") {
  const report_schedule x(0s);
  CHECK_FALSE(x.is_due(0s));
  CHECK_FALSE(x.is_due(24h));
}
