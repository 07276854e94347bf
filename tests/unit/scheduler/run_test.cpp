#include <chrono>
#include <csignal>

#include "io/loop.hpp"
#include "io/process/signal_watch.hpp"
#include "unit/scheduler/support.hpp"

using namespace scheduler_test;

namespace {

/// Sends itself a message without delay, for ever.
mark_actor::behavior_type spinning(mark_pointer self) {
  self->send(self, mark{});
  return {[self](mark) { self->send(self, mark{}); }};
}

} // namespace

TEST_CASE("a run executes what is due at its end and nothing later", "[scheduler][GEN-07]") {
  world world;
  events log;
  const auto to = world.spawn("", recorder, &log, 0);
  post_after(to, 10ms - 1ns, mark{1});
  post_after(to, 10ms, mark{2});
  post_after(to, 10ms + 1ns, mark{3});
  CHECK(world.run_until(instant(10ms)) == stop_cause::reached_end);
  CHECK(world.now() == instant(10ms));
  CHECK(log == events{{10ms - 1ns, 1}, {10ms, 2}});
  CHECK(world.run_for(1ns) == stop_cause::reached_end);
  CHECK(log.size() == 3);
  CHECK(world.now() == instant(10ms + 1ns));
}

TEST_CASE("a run without events reaches its end at once", "[scheduler][GEN-07]") {
  world world;
  CHECK(world.now() == instant());
  CHECK(world.run_for(0s) == stop_cause::reached_end);
  CHECK(world.run_for(24h) == stop_cause::reached_end);
  CHECK(world.now() == instant(24h));
  CHECK(!world.scheduler().next_timeout());
}

TEST_CASE("running in slices does the same as running in one go", "[scheduler][GEN-07]") {
  const auto run = [](std::vector<duration> slices) {
    world world;
    events log;
    const auto to = world.spawn("", recorder, &log, 0);
    for (int i = 0; i < 100; ++i)
      post_after(to, i * 1ms, mark{i});
    for (const auto slice : slices)
      world.run_for(slice);
    return log;
  };
  const auto whole = run({100ms});
  CHECK(whole.size() == 100);
  CHECK(run({1ms, 33ms, 0ms, 16ms, 50ms}) == whole);
}

TEST_CASE("a stop request ends the run where it is, and the next run goes on",
          "[scheduler][ACT-11]") {
  world world;
  events log;
  const auto to = world.spawn("", recorder, &log, 0);
  const auto stopping = world.spawn("", [&world](mark_pointer) -> mark_actor::behavior_type {
    return {[&world](mark) { world.request_stop(); }};
  });
  post_after(to, 1ms, mark{1});
  post_after(stopping, 2ms, mark{});
  post_after(to, 3ms, mark{3});
  CHECK(world.run_for(1h) == stop_cause::requested);
  CHECK(world.now() == instant(2ms));
  CHECK(log == events{{1ms, 1}});
  CHECK(world.run_until(instant(1h)) == stop_cause::reached_end);
  CHECK(log == events{{1ms, 1}, {3ms, 3}});
}

TEST_CASE("a stop requested before a run ends it at once, and only it", "[scheduler][ACT-11]") {
  world world;
  world.request_stop();
  world.request_stop();
  CHECK(world.run_for(1s) == stop_cause::requested);
  CHECK(world.now() == instant());
  CHECK(world.run_for(1s) == stop_cause::reached_end);
}

TEST_CASE("a signal stops a virtual run that would not end by itself", "[scheduler][ACT-11]") {
  const bool timers = GENERATE(false, true);
  io::loop loop;
  world world({.loop = &loop});
  const io::signal_watch watch(loop, [&](int) { world.request_stop(); });
  const auto busy = world.spawn("", spinning);
  const auto ticking = world.spawn("", [](mark_pointer self) -> mark_actor::behavior_type {
    self->send(self, mark{});
    return {[self](mark) { self->delayed_send(self, 1ns, mark{}); }};
  });
  if (timers)
    post_exit(busy, caf::exit_reason::kill);
  std::raise(SIGINT);
  CHECK(world.run_for(std::chrono::hours(24 * 365)) == stop_cause::requested);
}

TEST_CASE("draining executes what is ready and lets no time pass", "[scheduler][ACT-11]") {
  world world;
  events log;
  const auto to = world.spawn("", recorder, &log, 0);
  world.run_for(5ms);
  post_after(to, 1ms, mark{1});
  post(to, mark{2});
  world.request_stop();
  CHECK(world.drain());
  CHECK(log == events{{5ms, 2}});
  CHECK(world.now() == instant(5ms));
}

TEST_CASE("draining gives up on actors that never come to rest", "[scheduler][ACT-11]") {
  world world;
  const auto busy = world.spawn("", spinning);
  CHECK(!world.drain(10));
  CHECK(world.stats().resumes == 10);
}

TEST_CASE("actors asked to leave have left after a drain", "[scheduler][ACT-11]") {
  world world;
  const auto one = world.spawn("", mute);
  world.run_for(1s);
  CHECK(counted_state::alive == 1);
  post_exit(one, caf::exit_reason::user_shutdown);
  CHECK(world.drain());
  CHECK(counted_state::alive == 0);
}

TEST_CASE("turns and timeouts are counted", "[scheduler][ACT-06]") {
  world world;
  events log;
  const auto to = world.spawn("", recorder, &log, 0);
  world.run_for(0s);
  CHECK(world.stats().resumes == 1);
  for (int i = 1; i <= 3; ++i)
    post_after(to, i * 1s, mark{});
  world.run_for(10s);
  CHECK(world.stats().resumes == 4);
  CHECK(world.stats().timeouts == 3);
}

TEST_CASE("a pace slows virtual time down and changes nothing else", "[scheduler][GEN-07]") {
  const auto run = [](double speed) {
    world world({.speed = speed});
    events log;
    const auto to = world.spawn("to", recorder, &log, 0);
    for (int i = 0; i < 50; ++i)
      post_after(to, (i * 7 % 50) * 10ms, mark{i});
    const auto start = std::chrono::steady_clock::now();
    world.run_for(500ms);
    return std::pair(log, std::chrono::steady_clock::now() - start);
  };
  const auto fast = run(0);
  const auto paced = run(10);
  CHECK(paced.first == fast.first);
  CHECK(paced.second >= 50ms);
}
