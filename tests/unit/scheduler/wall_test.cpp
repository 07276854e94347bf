#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <thread>

#include "io/loop.hpp"
#include "unit/scheduler/support.hpp"

using namespace scheduler_test;

namespace {

auto real_now() {
  return std::chrono::steady_clock::now();
}

} // namespace

TEST_CASE("wall time passes as fast as the speed says", "[scheduler][GEN-07]") {
  const double speed = GENERATE(1.0, 20.0);
  world world({.mode = time_mode::wall, .speed = speed});
  const duration length(static_cast<std::int64_t>(30e6 * speed));
  events log;
  const auto to = world.spawn("", recorder, &log, 0);
  for (const int i : {3, 1, 2})
    post_after(to, i * length / 4, mark{i});
  CHECK(world.now() == instant());
  const auto start = real_now();
  CHECK(world.run_for(length) == stop_cause::reached_end);
  CHECK(real_now() - start >= 30ms - 1us);
  CHECK(world.now() == instant(length));
  REQUIRE(log.size() == 3);
  for (int i = 1; i <= 3; ++i) {
    CHECK(log[static_cast<std::size_t>(i - 1)].second == i);
    CHECK(log[static_cast<std::size_t>(i - 1)].first >= i * length / 4);
    CHECK(log[static_cast<std::size_t>(i - 1)].first <= length);
  }
}

TEST_CASE("wall time without a speed is real time", "[scheduler][GEN-07]") {
  world world({.mode = time_mode::wall});
  const auto start = real_now();
  world.run_for(20ms);
  CHECK(real_now() - start >= 20ms);
  CHECK(world.now() == instant(20ms));
}

TEST_CASE("between runs wall time stands still and catches up in the next", "[scheduler][GEN-07]") {
  world world({.mode = time_mode::wall});
  world.run_for(1ms);
  const auto pause = real_now() + 10ms;
  while (real_now() < pause)
    CHECK(world.now() == instant(1ms));
  events log;
  post_after(world.spawn("", recorder, &log, 0), 0s, mark{});
  world.run_for(5ms);
  REQUIRE(log.size() == 1);
  CHECK(log[0].first == 6ms); // the run's end: real time is beyond it
  CHECK(world.now() == instant(6ms));
}

TEST_CASE("wall time is never ahead of the real clock", "[scheduler][GEN-07]") {
  world world({.mode = time_mode::wall, .speed = 3});
  const auto start = real_now();
  bool ahead = false;
  const auto ticking = world.spawn("", [&](mark_pointer self) -> mark_actor::behavior_type {
    self->delayed_send(self, 1ms, mark{});
    return {[&, self](mark) {
      const auto seen = time_of(self);
      ahead = ahead || seen > 3 * (real_now() - start);
      self->delayed_send(self, 1ms, mark{});
    }};
  });
  world.run_for(60ms);
  CHECK(world.stats().timeouts > 0);
  CHECK(!ahead);
}

TEST_CASE("in wall time a flood of messages does not hold up timeouts", "[scheduler][GEN-07]") {
  world world({.mode = time_mode::wall});
  events log;
  const auto flooding = world.spawn("", [](mark_pointer self) -> mark_actor::behavior_type {
    self->send(self, mark{});
    return {[self](mark) { self->send(self, mark{}); }};
  });
  const auto stopping = world.spawn("", [&](mark_pointer self) -> mark_actor::behavior_type {
    self->delayed_send(self, 2ms, mark{1});
    return {[&, self](mark x) {
      log.emplace_back(time_of(self), x.value);
      world.request_stop();
    }};
  });
  CHECK(world.run_until(instant::max()) == stop_cause::requested);
  CHECK(log.size() == 1);
}

TEST_CASE("a stop in wall time leaves the clock where it is", "[scheduler][ACT-11]") {
  world world({.mode = time_mode::wall});
  const auto stopping = world.spawn("", [&](mark_pointer self) -> mark_actor::behavior_type {
    self->delayed_send(self, 5ms, mark{});
    return {[&](mark) { world.request_stop(); }};
  });
  CHECK(world.run_for(1h) == stop_cause::requested);
  const auto stopped = world.now();
  CHECK(stopped >= instant(5ms));
  const auto pause = real_now() + 2ms;
  while (real_now() < pause)
    CHECK(world.now() == stopped);
  CHECK(world.run_for(1ms) == stop_cause::reached_end);
  CHECK(world.now() == stopped + 1ms);
}

TEST_CASE("events that are late in wall time keep their order", "[scheduler][GEN-07]") {
  world world({.mode = time_mode::wall, .speed = 1e6});
  events log;
  const auto to = world.spawn("", recorder, &log, 0);
  for (int i = 0; i < 200; ++i)
    post_after(to, (i * 77 % 200) * 1s, mark{i * 77 % 200});
  world.run_for(200s);
  REQUIRE(log.size() == 200);
  for (int i = 0; i < 200; ++i)
    REQUIRE(log[static_cast<std::size_t>(i)].second == i);
}

TEST_CASE("another thread's messages and timeouts wake a waiting world", "[scheduler][GEN-07]") {
  world world({.mode = time_mode::wall, .speed = 100});
  std::atomic<int> received = 0;
  const auto to = world.spawn("", [&](mark_pointer) -> mark_actor::behavior_type {
    return {[&](mark x) {
      received += x.value;
      if (received == 111)
        world.request_stop();
    }};
  });
  std::thread other([to] {
    post(to, mark{1});
    post_after(to, 100ms, mark{10});
    post_at(to, instant(50ms), mark{100});
  });
  CHECK(world.run_for(10h) == stop_cause::requested);
  other.join();
  CHECK(received == 111);
}

TEST_CASE("another thread can stop a waiting world", "[scheduler][ACT-11]") {
  const auto mode = GENERATE(time_mode::wall, time_mode::virtual_time);
  world world({.mode = mode, .speed = 1});
  std::thread other([&] { world.request_stop(); });
  CHECK(world.run_for(1h) == stop_cause::requested);
  other.join();
  CHECK(world.now() < instant(1h));
}

TEST_CASE("many threads may send at once and nothing is lost", "[scheduler]") {
  const auto mode = GENERATE(time_mode::wall, time_mode::virtual_time);
  constexpr int threads = 4;
  constexpr int messages = 2000;
  world world({.mode = mode, .speed = 1});
  int received = 0;
  std::array<int, threads> last{};
  last.fill(-1);
  bool in_order = true;
  const auto to = world.spawn("sum", [&](mark_pointer) -> mark_actor::behavior_type {
    return {[&](mark x) {
      auto& previous = last[static_cast<std::size_t>(x.value % threads)];
      in_order = in_order && x.value / threads == previous + 1;
      previous = x.value / threads;
      if (++received == threads * messages)
        world.request_stop();
    }};
  });
  std::vector<std::thread> others;
  for (int i = 0; i < threads; ++i)
    others.emplace_back([&, i] {
      for (int j = 0; j < messages; ++j)
        post(to, mark{j * threads + i});
    });
  CHECK(world.run_for(1h) == stop_cause::requested);
  for (auto& x : others)
    x.join();
  CHECK(received == threads * messages);
  CHECK(in_order);
  CHECK(world.trace().events() == threads * messages);
}

TEST_CASE("other threads can set timeouts and ask for ends", "[scheduler][GEN-07]") {
  world world;
  events log;
  const auto to = world.spawn("", recorder, &log, 0);
  const auto leaving = world.spawn("", mute);
  std::thread([&] {
    for (const int i : {3, 1, 2})
      post_at(to, instant(i * 1s), mark{i});
    post_exit(leaving, caf::exit_reason::user_shutdown);
  }).join();
  world.run_for(10s);
  CHECK(log == events{{1s, 1}, {2s, 2}, {3s, 3}});
  CHECK(leaving.get().has_ended());
}

TEST_CASE("an actor of another thread's world may send as that thread does", "[scheduler]") {
  constexpr int messages = 1000;
  world home({.mode = time_mode::wall});
  std::vector<int> seen;
  const auto to = home.spawn("", [&](mark_pointer) -> mark_actor::behavior_type {
    return {[&](mark x) {
      seen.push_back(x.value);
      if (seen.size() == messages)
        home.request_stop();
    }};
  });
  std::thread other([to] {
    world away;
    const auto from = away.spawn("", [to](mark_pointer) -> mark_actor::behavior_type {
      return {[to](mark x) { post(to, x); }};
    });
    for (int i = 0; i < messages; ++i)
      post(from, mark{i});
    away.run_for(1s);
  });
  CHECK(home.run_for(1h) == stop_cause::requested);
  other.join();
  CHECK(std::ranges::is_sorted(seen));
}
