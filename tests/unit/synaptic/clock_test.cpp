#include <vector>

#include "support/catch.hpp"
#include "synaptic/rubicon_clock.hpp"

using namespace rubicon;
using namespace rubicon::synaptic;
using std::chrono::microseconds;
using std::chrono::milliseconds;

namespace {

/// A clock whose shared time can be set while it runs.
struct runner {
  rubicon_clock clock;
  tick_setting setting;
  instant now;
  microseconds ahead{}; ///< shared time minus own time
  std::vector<std::uint32_t> ticks;
  std::vector<instant> times;

  void update() {
    const auto shared =
        island_time(std::chrono::duration_cast<microseconds>(now.time_since_epoch()) + ahead);
    if (const auto x = clock.update(now, shared, setting)) {
      ticks.push_back(x->number);
      times.push_back(now);
    }
  }

  void run_until(instant end) {
    update();
    while (clock.deadline() && *clock.deadline() <= end) {
      now = *clock.deadline();
      update();
    }
    now = end;
  }
};

} // namespace

TEST_CASE("T counts the periods of the shared time", "[synaptic][SYN-11][CLK-02]") {
  runner x;
  x.ahead = 3h; // 21600 periods
  x.run_until(instant{2s});
  CHECK(x.ticks == std::vector<std::uint32_t>{21600, 21601, 21602, 21603, 21604});
  CHECK(x.times[1] == instant{500ms});
}

TEST_CASE("the clock begins when its setting says", "[synaptic][CLK-03]") {
  runner x;
  x.setting = {7, island_time{milliseconds{1200}}, milliseconds{100}};
  x.run_until(instant{1450ms});
  CHECK(x.ticks == std::vector<std::uint32_t>{7, 8, 9});
  CHECK(x.times[0] == instant{1200ms});
}

TEST_CASE("small corrections neither skip nor double a tick", "[synaptic][CLK-05]") {
  runner x;
  x.run_until(instant{10s});
  for (int i = 0; i < 40; ++i) {
    x.ahead += milliseconds{i % 3 == 0 ? -240 : i % 3 == 1 ? 230 : 10};
    x.run_until(x.now + duration(i * 37ms));
  }
  x.run_until(x.now + 5s);
  for (std::size_t i = 1; i < x.ticks.size(); ++i)
    REQUIRE(x.ticks[i] == x.ticks[i - 1] + 1);
  CHECK(x.ticks.size() > 60);
  CHECK(x.clock.leaps() == 0);
}

TEST_CASE("a large correction is followed and told", "[synaptic][CLK-05]") {
  runner x;
  x.run_until(instant{1100ms});
  x.ahead = 10s;
  x.run_until(instant{1600ms});
  CHECK(x.ticks == std::vector<std::uint32_t>{0, 1, 2, 22, 23});
  CHECK(x.clock.leaps() == 1);
  x.ahead = 0s;
  x.run_until(instant{2100ms});
  CHECK(x.ticks.back() == 4);
  CHECK(x.clock.leaps() == 2);
}

TEST_CASE("a change of the period takes effect at its tick", "[synaptic][CLK-03]") {
  runner x;
  x.run_until(instant{1900ms});
  x.setting = {4, island_time{milliseconds{2000}}, milliseconds{100}};
  x.run_until(instant{2250ms});
  CHECK(x.ticks == std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5, 6});
  CHECK(x.times.back() == instant{2200ms});
}

TEST_CASE("a clock that was stopped goes on with the next tick, and that is no leap",
          "[synaptic][CLK-05]") {
  runner x;
  const auto pause = GENERATE(duration(0s), duration(100ms), duration(10s));
  x.run_until(instant{1s});
  CHECK(x.ticks == std::vector<std::uint32_t>{0, 1, 2});
  x.clock.stop();
  CHECK_FALSE(x.clock.deadline().has_value());
  x.now += pause;
  x.run_until(x.now + 1s);
  const auto next = static_cast<std::uint32_t>(2 + pause / 500ms);
  CHECK(x.ticks[3] == next + (pause < 500ms ? 1 : 0));
  CHECK(x.ticks[4] == x.ticks[3] + 1);
  CHECK(x.clock.leaps() == 0);
}

TEST_CASE("T goes on from zero after its 32 bits, and that is no leap", "[synaptic][CLK-05]") {
  runner x;
  const auto corrected = GENERATE(0ms, 3ms, -3ms);
  const bool since_1970 = GENERATE(true, false);
  if (since_1970)
    x.ahead = 0xfffffffell * 500ms; // as a PC counts
  else
    x.setting = {0xfffffffe, island_time{}, 500ms};
  x.run_until(instant{1s});
  if (!since_1970)
    x.setting = {0, island_time{1s}, 500ms}; // as a mote learns later
  x.ahead += corrected;
  x.run_until(instant{2100ms});
  CHECK(x.ticks == std::vector<std::uint32_t>{0xfffffffe, 0xffffffff, 0, 1, 2});
  CHECK(x.clock.leaps() == 0);
}
