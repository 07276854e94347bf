#include "radio/channel/battery_watch.hpp"

#include <limits>

#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::radio;

namespace {

/// A radio that listens from the start, and its battery.
struct watched_battery {
  energy_meter meter;
  battery_watch battery;
  instant now;

  explicit watched_battery(double battery_mah)
      : meter(find_platform("micaz"), battery_mah, 0, instant()) {
    meter.enter(radio_state::listen, now);
    battery.begin(now);
  }

  battery_watch::finding look() {
    const auto due = battery.next_look(meter, now);
    REQUIRE(due);
    CHECK(*due >= now + 10ms);
    CHECK(battery.lasts_until() >= *due - 10ms);
    now = *due;
    return battery.look(meter, now);
  }

  battery_watch::finding look_until_low() {
    auto found = look();
    while (!found.runs_low) {
      CHECK(meter.battery_mah() - meter.used_mah(now) > meter.battery_mah() * battery_reserve);
      found = look();
    }
    return found;
  }
};

} // namespace

TEST_CASE("a battery's reserve is found once, and then its end", "[radio][power][NRG-05]") {
  watched_battery x(0.02);
  auto found = x.look_until_low();
  CHECK_FALSE(found.is_flat);
  CHECK(x.meter.used_mah(x.now) == Approx(0.019).epsilon(0.01));
  while (!found.is_flat) {
    CHECK(x.meter.used_mah(x.now) < 0.02);
    found = x.look();
    CHECK_FALSE(found.runs_low);
  }
  CHECK(x.meter.used_mah(x.now) >= 0.02);
  x.meter.stop(x.now);
  x.battery.run_down(x.now);
  CHECK(x.battery.lasts_until() == instant::max());
  const auto later = x.now + 1h;
  CHECK(x.battery.use(x.meter, x.meter.times(later), later).elapsed == x.now - instant());
}

TEST_CASE("a battery that ends before it is looked at is found low and flat at once",
          "[radio][power][NRG-05]") {
  watched_battery x(0.001);
  const auto found = x.battery.look(x.meter, instant(1h));
  CHECK(found.runs_low);
  CHECK(found.is_flat);
}

TEST_CASE("a battery that never ends is never looked at", "[radio][power][NRG-05]") {
  watched_battery x(std::numeric_limits<double>::infinity());
  CHECK_FALSE(x.battery.next_look(x.meter, instant(1h)));
  CHECK(x.battery.lasts_until() == instant::max());
}

TEST_CASE("another battery is counted from when it comes, and has a reserve of its own",
          "[radio][power][NRG-05]") {
  watched_battery x(0.02);
  x.look_until_low();
  const auto came = x.now;
  x.meter.restart(0.01, came);
  x.battery.begin(came);
  const auto use = x.battery.use(x.meter, x.meter.times(came), came);
  CHECK(use.elapsed == 0s);
  CHECK(use.used_mah == Approx(0.01));
  x.look_until_low();
  CHECK(x.now > came + 10ms);
  CHECK(x.meter.used_mah(x.now) == Approx(0.019).epsilon(0.01));
}
