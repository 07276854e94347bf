#include <string>

#include "report/invariants.hpp"
#include "report/time_watch.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::report;

namespace {

constexpr island_id home{1};
constexpr mote_address watched_fan{home, mote_id{2}};
constexpr mote_address watched_lamp{home, mote_id{3}};

mote_look good() {
  mote_look x;
  x.runs = x.has_route = true;
  x.hops = 2;
  x.clock_error = 100us;
  x.clock_doubt = 300us;
  x.messages = 0;
  return x;
}

/// An island of two motes, looked at every 10 s.
struct watched {
  explicit watched(bool sleeps = false) {
    healing_rules rules;
    rules.sleeps = sleeps;
    rules.period = 10s;
    rules.departure = 30s;
    rules.judges = true;
    watch.add_island(home, "home", rules);
    for (const auto& mote : {watched_fan, watched_lamp})
      watch.on_listed(mote, true, false, instant{1s});
  }

  void run_to(duration end) {
    while (now + time_watch::every <= instant(end)) {
      now += time_watch::every;
      watch.look(watched_fan, "home/fan", of_fan, now);
      watch.look(watched_lamp, "home/lamp", of_lamp, now);
    }
  }

  void list(bool listed, duration at) { watch.on_listed(watched_fan, listed, false, instant(at)); }

  [[nodiscard]] run_report report() const {
    run_report x;
    auto& island = x.islands.emplace_back();
    island.id = home;
    for (const auto& mote : {watched_fan, watched_lamp})
      island.motes.emplace_back().address = mote;
    watch.fill(x, now);
    return x;
  }
  [[nodiscard]] mote_report fan_report() const { return report().islands[0].motes[0]; }
  [[nodiscard]] clock_report clock() const { return report().islands[0].clock; }

  time_watch watch;
  mote_look of_fan = good();
  mote_look of_lamp = good();
  instant now;
};

} // namespace

TEST_CASE("a mote that is gone for long is a violation, though it comes back",
          "[report][invariants]") {
  watched x;
  x.run_to(1h);
  x.list(false, 3601s);
  x.run_to(3h);
  x.list(true, 3h + 5s);
  x.run_to(4h);
  const auto report = x.report();
  REQUIRE(report.violations.size() == 1);
  const auto& found = report.violations[0];
  CHECK(found.invariant == nobody_is_silent);
  CHECK(found.at == instant{3760s}); // 2 min, and 30 s in which its silence may not be noticed
  CHECK(found.detail ==
        "home/fan was silent for 2 h 00 min from 1:00:01: its gateway does not list "
        "it; the limit is 2 min 30 s");
  CHECK(x.fan_report().silence == 2h + 4s);
  CHECK(x.fan_report().silence_from == instant{3601s});
  CHECK(report.islands[0].motes[1].silence == 0s);
}

TEST_CASE("a silence that goes on is told at the end", "[report][invariants]") {
  watched x;
  x.list(false, 100s);
  x.run_to(10min);
  CHECK(x.report().violations.size() == 1);
  CHECK(x.fan_report().silence == 500s);
  CHECK(x.report().violations.size() == 1); // telling changes nothing
}

TEST_CASE("healing takes its time, from the end of its cause", "[report][invariants]") {
  const bool sleeps = GENERATE(false, true);
  watched x(sleeps);
  const duration bound = sleeps ? 2 * (40s + 2min) : 2min;
  x.run_to(1000s);
  SECTION("of its own") {
    x.list(false, 1000s);
    x.run_to(1000s + bound + 30s);
    CHECK(x.report().violations.empty());
    x.run_to(1000s + bound + 40s);
    CHECK(x.report().violations.size() == 1);
  }
  SECTION("after a fault of the island") {
    x.watch.on_cause(home, instant{2000s});
    x.list(false, 1500s);
    x.run_to(2000s + bound + 30s);
    CHECK(x.report().violations.empty());
    x.run_to(2000s + bound + 40s);
    CHECK(x.report().violations.size() == 1);
  }
  SECTION("after a fault of another island") {
    x.watch.on_cause(island_id{2}, instant{2000s});
    x.list(false, 1000s);
    x.run_to(1000s + bound + 40s);
    CHECK(x.report().violations.size() == 1);
  }
  SECTION("after it was out of order itself") {
    x.of_fan.runs = false;
    x.list(false, 1000s);
    x.run_to(2000s);
    x.of_fan.runs = true;
    x.run_to(2000s + bound + 40s);
    CHECK(x.report().violations.empty());
    CHECK(x.fan_report().silence < bound + 40s); // it had no power before
    x.run_to(2000s + bound + 60s);
    CHECK(x.report().violations.size() == 1);
  }
  SECTION("not while it has no power") {
    x.of_fan.runs = false;
    x.run_to(1010s);
    x.list(false, 1015s);
    x.run_to(3h);
    CHECK(x.report().violations.empty());
    CHECK(x.fan_report().silence == 0s);
  }
  SECTION("as long as the mote that it needs does not run") {
    x.of_lamp.runs = false;
    x.of_fan.has_route = false;
    x.list(false, 1000s);
    x.run_to(1h);
    CHECK(x.report().violations.empty());
    CHECK(x.fan_report().silence == 1h - 1000s);
  }
}

TEST_CASE("whoever has said goodbye, or never came, is not missed", "[report][invariants]") {
  watched x;
  x.watch.on_listed(watched_fan, false, true, instant{5s});
  const mote_address stranger{home, mote_id{9}};
  for (; x.now < instant{1h}; x.now += 10s) {
    x.watch.look(watched_fan, "home/fan", good(), x.now);
    x.watch.look(stranger, "home/stranger", good(), x.now);
  }
  CHECK(x.report().violations.empty());
  CHECK(x.fan_report().silence == 0s);
}

TEST_CASE("a listed mote whose messages do not arrive is silent", "[report][invariants]") {
  watched x;
  const auto send = [&x](std::uint64_t each, bool arrives, duration end) {
    while (x.now < instant(end)) {
      *x.of_fan.messages += each;
      x.of_fan.arrived += arrives ? each : 0;
      x.run_to(x.now.time_since_epoch() + 10s);
    }
  };
  SECTION("after they did") {
    send(1, true, 100s);
    send(1, false, 300s);
    const auto report = x.report();
    REQUIRE(report.violations.size() == 1);
    CHECK(report.violations[0].detail ==
          "home/fan was silent for 3 min 10 s from 1:50: it is listed, but none of its messages "
          "arrives; the limit is 2 min 30 s");
    CHECK(x.fan_report().silence == 190s);
    send(1, true, 320s);
    CHECK(x.fan_report().silence == 200s);
  }
  SECTION("but not if they never did: nobody may be there to take them") {
    send(1, false, 1000s);
    CHECK(x.report().violations.empty());
    CHECK(x.fan_report().silence == 0s);
  }
  SECTION("nor for two that were lost") {
    send(1, true, 100s);
    send(2, false, 110s);
    send(0, false, 1000s);
    CHECK(x.report().violations.empty());
    CHECK(x.fan_report().silence == 0s);
  }
}

TEST_CASE("clocks are judged all the time", "[report][invariants][CLK-01]") {
  watched x;
  x.run_to(100s);
  CHECK(x.clock().judged == 20);
  CHECK(x.clock().share_precise() == 1);
  x.of_fan.clock_error = 4ms;
  x.of_fan.clock_doubt = 5ms; // it says so, but radios are always on
  x.run_to(120s);
  x.of_fan.clock_error = 2s;
  x.run_to(260s);
  x.of_fan = good();
  x.run_to(300s);
  const auto clock = x.clock();
  CHECK(clock.judged == 60);
  CHECK(clock.below_1ms == 44);
  CHECK(clock.outside == 14);
  CHECK(clock.outside_longest == 160s);
  CHECK(clock.error_max == 2s);
  CHECK(clock.error_max_mote == "home/fan");
  CHECK(clock.error_max_at == instant{130s});
  const auto report = x.report();
  REQUIRE(report.violations.size() == 1);
  CHECK(report.violations[0].invariant == clocks_keep_their_bound);
  CHECK(report.violations[0].at == instant{240s});
  CHECK(report.violations[0].detail ==
        "home/fan had the wrong time for 2 min 40 s from 1:50; the limit is 2 min 00 s");
}

TEST_CASE("a clock may be wrong while it heals, and where it does not know better",
          "[report][invariants][CLK-01]") {
  watched x(true);
  x.of_fan.clock_error = 50ms;
  x.of_fan.clock_doubt = 60ms; // of a radio that sleeps
  x.run_to(1h);
  CHECK(x.clock().outside == 0);
  x.watch.on_cause(home, instant{2h});
  x.of_fan.clock_error = 100ms;
  x.run_to(2h + 5min);
  CHECK(x.clock().outside > 0);
  x.of_fan.clock_error.reset();
  x.run_to(3h);
  CHECK(x.report().violations.empty());
}
