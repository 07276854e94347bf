#include "device/walk.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using device::walk;

TEST_CASE("a walk goes straight from waypoint to waypoint", "[device][walk][NET-15]") {
  const walk x({{1s, {0, 0, 0}}, {3s, {10, 20, 2}}, {4s, {10, 20, 2}}, {5s, {0, 0, 0}}}, 500ms);
  CHECK(x.at(instant(0s)) == position{0, 0, 0}); // it waits for its first moment there
  CHECK(x.at(instant(1s)) == position{0, 0, 0});
  CHECK(x.at(instant(1500ms)) == position{2.5, 5, 0.5});
  CHECK(x.at(instant(2s)) == position{5, 10, 1});
  CHECK(x.at(instant(3500ms)) == position{10, 20, 2});
  CHECK(x.at(instant(5s)) == position{0, 0, 0});
  CHECK(x.at(instant(1h)) == position{0, 0, 0});
}

TEST_CASE("a walk is brought up to date every step while it moves", "[device][walk]") {
  const walk x({{1s, {0, 0, 0}}, {2s, {10, 0, 0}}, {10s, {10, 0, 0}}, {11s, {0, 0, 0}}}, 400ms);
  CHECK(x.next(instant(0s)) == instant(1s));
  CHECK(x.next(instant(1s)) == instant(1400ms));
  CHECK(x.next(instant(1400ms)) == instant(1800ms));
  CHECK(x.next(instant(1800ms)) == instant(2s)); // never past a waypoint
  CHECK(x.next(instant(2s)) == instant(10s));    // it stands
  CHECK(x.next(instant(10800ms)) == instant(11s));
  CHECK_FALSE(x.next(instant(11s)));
}

TEST_CASE("without waypoints nothing moves", "[device][walk]") {
  CHECK(walk().empty());
  CHECK_FALSE(walk().next(instant{}));
}
