#include <optional>
#include <stdexcept>

#include "unit/scheduler/support.hpp"

using namespace scheduler_test;

TEST_CASE("messages that may be moved are set, moved and taken back one by one",
          "[scheduler][GEN-07]") {
  world world;
  auto& here = world.scheduler().supervisor();
  events log;
  const auto to = world.spawn("", recorder, &log, 0);
  const auto set = [&](duration due, int value) {
    return here.schedule(instant(due), to.strong(), make_envelope(mark{value}));
  };
  const auto one = set(10ms, 1);
  const auto two = set(20ms, 2);
  const auto three = set(30ms, 3);
  CHECK(here.move(one, instant(25ms)));
  CHECK(here.move(three, instant(5ms)));
  here.timeouts().cancel(two);
  CHECK(!here.move(two, instant(15ms)));
  CHECK(world.scheduler().next_timeout() == instant(5ms));
  CHECK(world.stats().waiting == 2);
  world.run_for(1s);
  CHECK(log == events{{5ms, 3}, {25ms, 1}});
  CHECK(!world.scheduler().next_timeout());
}

TEST_CASE("a message that was delivered cannot be moved, nor can who has its place be by it",
          "[scheduler][GEN-07]") {
  world world;
  auto& here = world.scheduler().supervisor();
  events log;
  const auto to = world.spawn("", recorder, &log, 0);
  const auto first = here.schedule(instant(1ms), to.strong(), make_envelope(mark{1}));
  world.run_for(2ms);
  const auto second = here.schedule(instant(5ms), to.strong(), make_envelope(mark{2}));
  CHECK(!here.move(first, instant(9ms)));
  CHECK(!here.move(movable_message(), instant(9ms)));
  here.timeouts().cancel(first);
  here.timeouts().cancel(movable_message());
  CHECK(here.move(second, instant(6ms)));
  world.run_for(1s);
  CHECK(log == events{{1ms, 1}, {6ms, 2}});
}

TEST_CASE("a message that is moved to the past arrives now", "[scheduler][GEN-07]") {
  world world;
  auto& here = world.scheduler().supervisor();
  events log;
  const auto to = world.spawn("", recorder, &log, 0);
  const auto x = here.schedule(instant(1h), to.strong(), make_envelope(mark{1}));
  world.run_for(10ms);
  CHECK(here.move(x, instant(5ms)));
  world.run_for(1s);
  CHECK(log == events{{10ms, 1}});
}

TEST_CASE("timeouts that alone keep an actor alive can be cancelled", "[scheduler]") {
  world world;
  auto& here = world.scheduler().supervisor();
  std::vector<movable_message> pending;
  auto one = std::optional(world.spawn("", mute));
  world.run_for(0s);
  for (int i = 0; i < 5; ++i)
    pending.push_back(here.schedule(instant(1s), one->strong(), make_envelope(mark{i})));
  one.reset();
  CHECK(counted_state::alive == 1);
  SECTION("one by one") {
    for (const auto& x : pending) {
      CHECK(counted_state::alive == 1);
      here.timeouts().cancel(x);
    }
  }
  SECTION("all") {
    world.scheduler().close_clock();
  }
  CHECK(counted_state::alive == 0);
  world.run_for(10s);
  CHECK(world.stats().timeouts == 0);
}

TEST_CASE("the clock refuses what only CAF's own actors would ask of it", "[scheduler]") {
  world world;
  auto& clock = world.system().clock();
  const auto t = to_clock_time(instant(1s));
  const auto to = world.spawn("", mute);
  auto* const inside = to.strong()->get();
  CHECK_THROWS_AS(clock.set_ordinary_timeout(t, inside, caf::atom("a"), 1), std::logic_error);
  CHECK_THROWS_AS(clock.set_multi_timeout(t, inside, caf::atom("a"), 1), std::logic_error);
  CHECK_THROWS_AS(clock.set_request_timeout(t, inside, caf::make_message_id(1)), std::logic_error);
  CHECK_THROWS_AS(clock.schedule_message(t, to.strong(), caf::mailbox_element_ptr()),
                  std::logic_error);
  CHECK_THROWS_AS(clock.schedule_message(t, caf::group(), nullptr, caf::message()),
                  std::logic_error);
  clock.cancel_ordinary_timeout(inside, caf::atom("a")); // there is none: nothing happens
  clock.cancel_request_timeout(inside, caf::make_message_id(1));
  clock.cancel_timeouts(inside);
  clock.cancel_all();
  CHECK(!world.scheduler().next_timeout());
}

TEST_CASE("ecology time is CAF's time since the epoch", "[scheduler][GEN-07]") {
  world world;
  CHECK(world.system().clock().now().time_since_epoch() == 0s);
  world.run_for(90s);
  CHECK(world.system().clock().now().time_since_epoch() == 90s);
  CHECK(to_instant(world.system().clock().now()) == instant(90s));
  CHECK(to_clock_time(instant(90s)) == world.system().clock().now());
}
