#include "device/actuator.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::device;

namespace {

instant at(duration t) {
  return instant{t};
}

actuator blind(std::uint8_t initial = 0) {
  return actuator({"blind", actuator_kind::level, initial, 51s}); // 0.2 s for each of 255
}

} // namespace

TEST_CASE("a relay switches at once and has two states", "[device][DIS-02]") {
  actuator x({"fan", actuator_kind::relay, 0, {}});
  CHECK(x.state(at(0s)) == 0);
  CHECK(x.set(1, at(1s)));
  CHECK(x.state(at(1s)) == 1);
  CHECK_FALSE(x.deadline());
  CHECK_FALSE(x.set(2, at(2s)));
  CHECK(x.state(at(2s)) == 1);
  CHECK(x.target() == 1);
}

TEST_CASE("a dimmer without a fade changes at once", "[device][DIS-02]") {
  actuator x({"lamp", actuator_kind::dimmer, 9, {}});
  CHECK(x.state(at(0s)) == 9);
  CHECK(x.set(255, at(0s)));
  CHECK(x.state(at(0s)) == 255);
  CHECK_FALSE(x.deadline());
  CHECK_FALSE(x.on_time(at(1s)));
}

TEST_CASE("a level moves at constant speed and tells when it has arrived", "[device][DIS-02]") {
  auto x = blind();
  CHECK(x.set(100, at(10s)));
  CHECK(x.target() == 100);
  CHECK(x.deadline() == at(30s));
  CHECK(x.state(at(10s)) == 0);
  CHECK(x.state(at(10s + 99ms)) == 0);
  CHECK(x.state(at(10s + 100ms)) == 1); // nearest
  CHECK(x.state(at(20s)) == 50);
  CHECK_FALSE(x.on_time(at(30s - 1ns)));
  CHECK(x.state(at(30s)) == 100);
  CHECK(x.on_time(at(30s)));
  CHECK_FALSE(x.deadline());
  CHECK_FALSE(x.on_time(at(31s)));
  CHECK(x.set(0, at(40s)));
  CHECK(x.deadline() == at(60s));
  CHECK(x.state(at(50s)) == 50);
}

TEST_CASE("a level that is sent elsewhere turns where it is", "[device][DIS-02]") {
  auto x = blind(200);
  CHECK(x.state(at(0s)) == 200);
  CHECK(x.set(100, at(0s)));
  CHECK(x.set(255, at(10s))); // at 150
  CHECK(x.state(at(10s)) == 150);
  CHECK(x.deadline() == at(31s));
  CHECK(x.set(255, at(11s))); // the same again changes nothing
  CHECK(x.deadline() == at(31s));
  CHECK(x.set(155, at(11s))); // stop here
  CHECK_FALSE(x.deadline());
  CHECK(x.state(at(12s)) == 155);
}

TEST_CASE("a movement that has ended unnoticed is the start of the next one", "[device][DIS-02]") {
  auto x = blind();
  CHECK(x.set(50, at(0s)));
  CHECK(x.set(100, at(1h)));
  CHECK(x.state(at(1h)) == 50);
  CHECK(x.deadline() == at(1h + 10s));
  CHECK(x.state(at(59min)) == 50); // a clock that goes back moves nothing
}

TEST_CASE("every level is where it was sent, from wherever it came", "[device][DIS-02]") {
  const auto travel = GENERATE(duration(0s), duration(1ns), duration(1s), duration(24h));
  instant now{};
  actuator x({"valve", actuator_kind::level, 0, travel});
  for (unsigned i = 0; i < 600; ++i) {
    const auto target = static_cast<std::uint8_t>(i * 77);
    CHECK(x.set(target, now));
    if (i % 3 == 0 && x.deadline()) {
      now += (*x.deadline() - now) / 3; // moved on from the middle of its travel
      continue;
    }
    now = x.deadline().value_or(now);
    CHECK(x.state(now) == target);
    static_cast<void>(x.on_time(now));
    CHECK(x.state(now) == target);
  }
}
