#include <limits>

#include "core/numbers/random.hpp"
#include "radio/energy.hpp"
#include "support/catch.hpp"
#include "unit/radio/samples.hpp"

using namespace rubicon;
using namespace rubicon::radio;
using test::micaz;
using test::radio_sum;

namespace {} // namespace

TEST_CASE("each state costs its current", "[radio][energy][NRG-05]") {
  for (const auto& kind : platforms()) {
    INFO(kind.name);
    const auto only = [&](duration energy_times::*part) {
      energy_times x;
      x.*part = 1h;
      return used_mah(x, kind, 12.5);
    };
    CHECK(only(&energy_times::radio_off) == Approx(kind.radio_off_ma));
    CHECK(only(&energy_times::radio_listen) == Approx(kind.radio_listen_ma));
    CHECK(only(&energy_times::radio_receive) == Approx(kind.radio_listen_ma));
    CHECK(only(&energy_times::radio_transmit) == Approx(12.5));
    CHECK(only(&energy_times::mcu_active) == Approx(kind.mcu_active_ma));
    CHECK(only(&energy_times::mcu_sleep) == Approx(kind.mcu_sleep_ma));
  }
}

TEST_CASE("transmit current lies between the settings of the table", "[radio][energy][NRG-05]") {
  for (const auto& kind : platforms())
    for (const auto& level : kind.transmit)
      CHECK(kind.transmit_ma(level.dbm) == level.current_ma);
  CHECK(micaz.transmit_ma(-20) == Approx(9.2));
  CHECK(micaz.transmit_ma(-4) == Approx(14.55));
  CHECK(micaz.transmit_ma(-40) == 8.5);
  CHECK(micaz.transmit_ma(5) == 17.4);
  const auto& iris = *find_platform("iris");
  CHECK(iris.transmit_dbm_max() == 3);
  CHECK(iris.transmit_ma(-30) == 9.5);
  CHECK(iris.transmit_ma(-10) == Approx(11.25));
  CHECK(iris.transmit_ma(0) == Approx(14.75));
}

TEST_CASE("a meter radio_counters each state's time", "[radio][energy][NRG-05]") {
  energy_meter x(&micaz, 2000, 0, instant(10s));
  x.enter(radio_state::listen, instant(11s));
  CHECK(x.work(2s, instant(14s)) == instant(16s));
  x.enter(radio_state::transmit, instant(16s));
  const auto times = x.times(instant(20s));
  CHECK(times.radio_off == 1s);
  CHECK(times.radio_listen == 5s);
  CHECK(times.radio_receive == 0s); // the medium counts it
  CHECK(times.radio_transmit == 4s);
  CHECK(times.mcu_active == 2s);
  CHECK(times.mcu_sleep == 8s);
  CHECK(x.used_mah(instant(20s)) ==
        Approx((0.001 * 1 + 18.8 * 5 + 17.4 * 4 + 8.0 * 2 + 0.015 * 8) / 3600));
}

TEST_CASE("sending costs what its power costs", "[radio][energy][NRG-05]") {
  for (const auto& [dbm, current_ma] : {std::pair{-25.0, 8.5}, {-10.0, 11.2}, {0.0, 17.4}}) {
    energy_meter x(&micaz, 1, dbm, instant{});
    x.enter(radio_state::transmit, instant{});
    CHECK(x.used_mah(instant(100s)) == Approx(100 * (current_ma + 0.015) / 3600));
    CHECK(seconds(x.empty_at(instant{}).time_since_epoch()) == Approx(3600 / (current_ma + 0.015)));
  }
}

TEST_CASE("work queues up, counts as it is done, and can be dropped", "[radio][energy]") {
  energy_meter x(&micaz, 2000, 0, instant{});
  CHECK(x.work(3s, instant(1s)) == instant(4s));
  CHECK(x.work(3s, instant(2s)) == instant(7s));
  CHECK(x.times(instant(5s)).mcu_active == 4s);
  CHECK(x.times(instant(9s)).mcu_active == 6s);
  x.drop_work(instant(5s));
  CHECK(x.times(instant(9s)).mcu_active == 4s);
  x.drop_work(instant(9s));
  CHECK(x.times(instant(9s)).mcu_active == 4s);
  CHECK(x.work(1s, instant(9s)) == instant(10s));
}

TEST_CASE("a computation costs its time once, whatever else is worked", "[radio][energy][NRG-05]") {
  energy_meter x(&micaz, 2000, 0, instant{});
  x.compute(2s, instant(1s));
  CHECK(x.work(100ms, instant(2s)) == instant(2100ms)); // at once
  CHECK(x.times(instant(2s)).mcu_active == 1s);
  CHECK(x.times(instant(9s)).mcu_active == 2s);
  x.compute(2s, instant(10s));
  x.compute(2s, instant(11s)); // one after the other
  CHECK(x.work(1s, instant(13500ms)) == instant(14500ms));
  CHECK(x.times(instant(20s)).mcu_active == 6500ms);
  static_cast<void>(x.work(3s, instant(30s)));
  x.compute(1s, instant(30s));
  x.drop_work(instant(30s)); // the radio is off: it computes on
  CHECK(x.times(instant(40s)).mcu_active == 7500ms);
  x.compute(9s, instant(40s));
  x.stop(instant(41s));
  CHECK(x.times(instant(60s)).mcu_active == 8500ms);
  x.compute(1s, instant(61s));
  CHECK(x.times(instant(70s)).mcu_active == 8500ms);
}

TEST_CASE("times add up to the time that has passed, always", "[radio][energy][NRG-05]") {
  random_stream rng(4);
  energy_meter x(&micaz, 2000, 0, instant(5ms));
  instant now(5ms);
  for (int i = 0; i < 5000; ++i) {
    now += rng.between(0ns, 3ms);
    if (rng.chance(0.3))
      x.work(rng.between(0ns, 4ms), now);
    else if (rng.chance(0.05))
      x.drop_work(now);
    else
      x.enter(static_cast<radio_state>(rng.below(3)), now);
    const auto times = x.times(now);
    const auto passed = now - instant(5ms);
    if (radio_sum(times) != passed || times.mcu_active + times.mcu_sleep != passed ||
        times.mcu_sleep < 0ns)
      FAIL("step " << i);
    CHECK(x.used_mah(now) == Approx(used_mah(times, micaz, 17.4)));
  }
}

TEST_CASE("the end of a battery is foretold", "[radio][energy][NRG-05]") {
  energy_meter x(&micaz, 1, 0, instant{});
  x.enter(radio_state::listen, instant{});
  const auto expected_s = 3600 / (18.8 + 0.015);
  CHECK(seconds(x.empty_at(instant{}).time_since_epoch()) == Approx(expected_s));
  CHECK(seconds(x.empty_at(instant(100s)).time_since_epoch()) == Approx(expected_s));
  CHECK(x.used_mah(x.empty_at(instant{})) == Approx(1));

  x.work(50s, instant(100s)); // work shortens it
  const auto with_work = x.empty_at(instant(100s));
  CHECK(seconds(with_work.time_since_epoch()) ==
        Approx(expected_s - 50 * (8 - 0.015) / (18.8 + 0.015)));
  CHECK(x.used_mah(with_work) == Approx(1));

  x.work(1h, instant(150s)); // more work than the battery can feed
  CHECK(x.used_mah(x.empty_at(instant(150s))) == Approx(1));

  CHECK(x.lasts_until(instant(100s)) <= x.empty_at(instant(100s)));
  CHECK(x.lasts_until(instant(100s)) > instant(100s));
  CHECK(x.empty_at(instant(1h)) == instant(1h)); // long empty
  CHECK(x.lasts_until(instant(1h)) == instant(1h));
}

TEST_CASE("two AA cells listen for as long as tinyos.md 8.2 says", "[radio][energy][NRG-05]") {
  for (const auto& [name, hours] : {std::pair{"micaz", 74.0}, std::pair{"telosb", 92.0}}) {
    const auto& kind = *find_platform(name);
    energy_meter x(&kind, kind.battery_mah, 0, instant{});
    x.enter(radio_state::listen, instant{});
    x.work(1000h, instant{}); // its figures have the MCU on all the time
    CHECK(seconds(x.empty_at(instant{}).time_since_epoch()) / 3600 == Approx(hours).epsilon(0.06));
  }
}

TEST_CASE("a mote on a cable never runs out", "[radio][energy]") {
  energy_meter x(&micaz, std::numeric_limits<double>::infinity(), 0, instant{});
  x.enter(radio_state::transmit, instant{});
  CHECK(x.empty_at(instant(1h)) == instant::max());
  CHECK(x.lasts_until(instant(1h)) == instant::max());
}

TEST_CASE("a stopped meter stands still", "[radio][energy][NRG-05]") {
  energy_meter x(&micaz, 2000, 0, instant{});
  x.enter(radio_state::listen, instant(1s));
  x.work(10s, instant(2s));
  x.stop(instant(4s));
  const auto used = x.used_mah(instant(4s));
  CHECK(x.stopped());
  x.enter(radio_state::transmit, instant(5s));
  CHECK(x.work(1s, instant(5s)) == instant(5s));
  x.stop(instant(6s));
  const auto times = x.times(instant(1h));
  CHECK(times.radio_off == 1s);
  CHECK(times.radio_listen == 3s);
  CHECK(times.mcu_active == 2s);
  CHECK(times.mcu_sleep == 2s);
  CHECK(x.used_mah(instant(1h)) == used);
  CHECK(x.empty_at(instant(1h)) == instant(4s));
}
