#include <algorithm>

#include "unit/scheduler/support.hpp"

using namespace scheduler_test;

TEST_CASE("ready actors run in the order in which they became ready", "[scheduler][GEN-07]") {
  world world;
  events log;
  std::vector<mark_actor> all;
  for (int i = 0; i < 5; ++i)
    all.push_back(world.spawn("", recorder, &log, i * 10));
  world.run_for(0s); // first turns
  for (const int i : {3, 1, 4, 0, 2})
    post(all[static_cast<std::size_t>(i)], mark{1});
  world.run_for(0s);
  CHECK(log == events{{0s, 31}, {0s, 11}, {0s, 41}, {0s, 1}, {0s, 21}});
}

TEST_CASE("messages from one actor to another keep their order", "[scheduler][GEN-07]") {
  world world;
  events log;
  const auto to = world.spawn("", recorder, &log, 0);
  for (int i = 0; i < 1000; ++i)
    post(to, mark{i});
  world.run_for(0s);
  REQUIRE(log.size() == 1000);
  for (int i = 0; i < 1000; ++i)
    REQUIRE(log[static_cast<std::size_t>(i)].second == i);
}

TEST_CASE("an actor with many messages lets others have their turn", "[scheduler][GEN-07]") {
  world world;
  events log;
  const auto busy = world.spawn("", recorder, &log, 0);
  const auto other = world.spawn("", recorder, &log, 1000);
  for (int i = 0; i < 500; ++i)
    post(busy, mark{i});
  post(other, mark{0});
  world.run_for(0s);
  REQUIRE(log.size() == 501);
  const auto position = std::find(log.begin(), log.end(), event{0s, 1000}) - log.begin();
  CHECK(position > 0);
  CHECK(position < 100);
}

TEST_CASE("delayed messages arrive at their time, whatever the order of sending",
          "[scheduler][GEN-07]") {
  world world;
  events log;
  const auto to = world.spawn("", recorder, &log, 0);
  for (const int i : {50, 10, 40, 20, 30})
    post_after(to, i * 1ms, mark{i});
  world.run_for(1s);
  CHECK(log == events{{10ms, 10}, {20ms, 20}, {30ms, 30}, {40ms, 40}, {50ms, 50}});
  CHECK(world.now() == instant(1s));
}

TEST_CASE("delayed messages for the same time arrive in the order of sending",
          "[scheduler][GEN-07]") {
  world world;
  events log;
  std::vector<mark_actor> all;
  for (int i = 0; i < 3; ++i)
    all.push_back(world.spawn("", recorder, &log, i * 100));
  for (const auto i : std::vector<std::size_t>{2, 0, 1}) {
    post_after(all[i], 5ms, mark{1});
    post_after(all[i], 4ms, mark{0});
  }
  world.run_for(10ms);
  CHECK(log == events{{4ms, 200}, {4ms, 0}, {4ms, 100}, {5ms, 201}, {5ms, 1}, {5ms, 101}});
}

TEST_CASE(
    "what an event causes at once comes after other events of the same time, before later ones",
    "[scheduler][GEN-07]") {
  world world;
  events log;
  const auto to = world.spawn("", recorder, &log, 0);
  const auto relay = world.spawn("", [to](mark_pointer self) -> mark_actor::behavior_type {
    return {[=](mark x) {
      self->send(to, mark{x.value});
      self->delayed_send(to, 0s, mark{x.value + 1});
    }};
  });
  post_after(relay, 1ms, mark{100});
  post_after(to, 1ms, mark{1});
  post_after(to, 1ms + 1ns, mark{2});
  world.run_for(1s);
  CHECK(log == events{{1ms, 1}, {1ms, 100}, {1ms, 101}, {1ms + 1ns, 2}});
}

TEST_CASE("a message scheduled for a time that has passed arrives now, behind what is due now",
          "[scheduler][GEN-07]") {
  world world;
  events log;
  world.run_for(1s);
  const auto to = world.spawn("", recorder, &log, 0);
  post_after(to, 0s, mark{1});
  const auto sender = world.spawn("", [to](mark_pointer self) -> mark_actor::behavior_type {
    self->scheduled_send(to, instant(1ms), mark{2});
    return {[](mark) {}};
  });
  world.run_for(1s);
  CHECK(log == events{{1s, 1}, {1s, 2}});
}

TEST_CASE("a periodic timer keeps its period exactly", "[scheduler][GEN-07]") {
  world world;
  events log;
  const auto ticking = world.spawn("", [&log](mark_pointer self) -> mark_actor::behavior_type {
    self->delayed_send(self, 7ms, mark{0});
    return {[self, &log](mark x) {
      log.emplace_back(time_of(self), x.value);
      self->delayed_send(self, 7ms, mark{x.value + 1});
    }};
  });
  world.run_for(7s);
  REQUIRE(log.size() == 1000);
  CHECK(log.front() == event{7ms, 0});
  CHECK(log.back() == event{7s, 999});
}
