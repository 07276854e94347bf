#include <deque>
#include <map>
#include <memory>

#include "core/numbers/random.hpp"
#include "parallel/ready_queue.hpp"
#include "parallel/timer_queue.hpp"
#include "support/catch.hpp"

using namespace rubicon;

namespace {

using queue = parallel::timer_queue<std::shared_ptr<int>>;

instant at_ns(std::int64_t ns) {
  return instant(duration(ns));
}

/// Of one origin, after all that was set before.
parallel::event_order in_turn(instant due) {
  static std::uint64_t sequence = 0;
  return {due, 0, sequence++};
}

template <class T>
auto add(parallel::timer_queue<T>& timers, instant due, T x) {
  return timers.add(in_turn(due), std::move(x));
}

} // namespace

TEST_CASE("timers come out by time, equal times in the order they went in", "[parallel][GEN-07]") {
  random_stream rng(7);
  queue timers;
  std::multimap<instant, int> expected; // keeps the order of equal keys
  for (int i = 0; i < 5000; ++i) {
    const auto due = at_ns(static_cast<std::int64_t>(rng.below(500)));
    add(timers, due, std::make_shared<int>(i));
    expected.emplace(due, i);
  }
  for (const auto& [due, value] : expected) {
    REQUIRE(timers.next() == due);
    REQUIRE(*timers.pop() == value);
  }
  CHECK(timers.empty());
  CHECK(!timers.next());
}

TEST_CASE("timers behave like a sorted list under any mixture of operations",
          "[parallel][GEN-07]") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    random_stream rng(seed);
    queue timers;
    std::multimap<instant, std::pair<int, queue::ticket>> expected;
    auto now = at_ns(0);
    for (int i = 0; i < 3000; ++i) {
      const auto what = rng.below(10);
      if (what < 5) {
        const auto due = now + duration(rng.below(50));
        expected.emplace(due, std::pair(i, add(timers, due, std::make_shared<int>(i))));
      } else if (what < 9 && !expected.empty()) {
        const auto victim =
            std::next(expected.begin(), static_cast<std::ptrdiff_t>(rng.below(expected.size())));
        const auto chosen = victim->second;
        expected.erase(victim);
        if (what < 7) {
          timers.cancel(chosen.second);
          REQUIRE(!timers.pending(chosen.second));
        } else {
          const auto due = now + duration(rng.below(50));
          timers.move(chosen.second, in_turn(due));
          expected.emplace(due, chosen);
        }
      } else if (!expected.empty()) {
        now = expected.begin()->first;
        REQUIRE(timers.next() == now);
        REQUIRE(timers.front() == expected.begin()->second.second);
        REQUIRE(*timers.pop() == expected.begin()->second.first);
        expected.erase(expected.begin());
      }
      REQUIRE(timers.size() == expected.size());
    }
  }
}

TEST_CASE("a timer that is moved comes after those that are due then already",
          "[parallel][GEN-07]") {
  queue timers;
  const auto first = add(timers, at_ns(1), std::make_shared<int>(1));
  add(timers, at_ns(2), std::make_shared<int>(2));
  timers.move(first, in_turn(at_ns(2)));
  CHECK(*timers.pop() == 2);
  CHECK(*timers.pop() == 1);
}

TEST_CASE("a cancelled timer is destroyed at once and its memory is used again", "[parallel]") {
  queue timers;
  const auto value = std::make_shared<int>(1);
  add(timers, at_ns(5), std::make_shared<int>(0));
  for (int i = 0; i < 1'000'000; ++i) {
    const auto ticket = add(timers, at_ns(1'000'000'000 + i), value);
    timers.cancel(ticket);
    if (value.use_count() != 1)
      FAIL("a cancelled timer holds its value");
  }
  CHECK(timers.size() == 1);
  CHECK(add(timers, at_ns(7), value) < 2);
  CHECK(*timers.pop() == 0);
  CHECK(timers.pop() == value);
  CHECK(!timers.next());
}

TEST_CASE("clearing timers destroys them all", "[parallel]") {
  queue timers;
  const auto value = std::make_shared<int>(1);
  for (int i = 0; i < 10; ++i)
    add(timers, at_ns(i), value);
  CHECK(value.use_count() == 11);
  timers.clear();
  CHECK(value.use_count() == 1);
  CHECK(timers.empty());
  add(timers, at_ns(3), value);
  CHECK(timers.next() == at_ns(3));
}

TEST_CASE("the ready queue is first in, first out while it grows and wraps around", "[parallel]") {
  random_stream rng(3);
  parallel::ready_queue<int> ready;
  std::deque<int> expected;
  for (int i = 0; i < 20'000; ++i) {
    // Long stretches of growth and of shrinking.
    if (rng.chance((i / 2000) % 2 == 0 ? 0.7 : 0.3)) {
      ready.push(i);
      expected.push_back(i);
    } else if (!expected.empty()) {
      REQUIRE(ready.pop() == expected.front());
      expected.pop_front();
    }
    REQUIRE(ready.size() == expected.size());
    REQUIRE(ready.empty() == expected.empty());
  }
}
