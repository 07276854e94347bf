#include <algorithm>
#include <vector>

#include "core/numbers/random.hpp"
#include "smepp/events/energy.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::smepp;
using std::chrono::milliseconds;

namespace {

instant at_ms(int ms) {
  return instant{} + milliseconds(ms);
}

/// When the radio goes on and off, in ms, until then.
std::vector<int> changes(const energy& x, int until_ms) {
  std::vector<int> all;
  bool on = x.is_on(at_ms(0));
  for (auto now = at_ms(0);;) {
    const auto next = x.next_change(now);
    if (!next || *next >= at_ms(until_ms))
      return all;
    REQUIRE(*next > now);
    now = *next;
    if (x.is_on(now) != on) {
      on = !on;
      all.push_back(static_cast<int>((now - at_ms(0)) / 1ms));
    }
  }
}

} // namespace

TEST_CASE("the radio follows the union of the cycles, as in figure 11", "[smepp][SMP-23][SMP-24]") {
  energy x({.tolerance = 30ms, .radio_delay = 10ms});
  x.set(0, {at_ms(100), 1000ms, 100ms}); // management
  x.set(1, {at_ms(150), 500ms, 100ms});  // subs1: the first window overlaps that of management
  x.set(2, {at_ms(270), 1000ms, 50ms});  // subs2: 20 ms behind that of subs1
  CHECK(changes(x, 1090) == std::vector<int>{90, 330, 640, 760});
  x.remove(2);
  CHECK(changes(x, 1090) == std::vector<int>{90, 260, 640, 760});
  x.remove(1);
  CHECK(changes(x, 1200) == std::vector<int>{90, 210, 1090});
  x.remove(0);
  CHECK(changes(x, 2000).empty());
  CHECK_FALSE(x.is_on(at_ms(120)));
}

TEST_CASE("windows closer than the tolerance are one", "[smepp][SMP-24]") {
  for (const int tolerance : {0, 50, 51}) {
    energy x({.tolerance = milliseconds(tolerance), .radio_delay = 0ms});
    x.set(0, {at_ms(0), 1000ms, 100ms});
    x.set(1, {at_ms(150), 1000ms, 100ms});
    const bool is_one = tolerance > 50;
    CHECK(changes(x, 1000) == (is_one ? std::vector<int>{250} : std::vector<int>{100, 150, 250}));
  }
}

TEST_CASE("the radio is on a while before and after each window", "[smepp][SMP-24]") {
  for (const int delay : {0, 1, 25}) {
    energy x({.tolerance = 0ms, .radio_delay = milliseconds(delay)});
    x.set(0, {at_ms(100), 1000ms, 100ms});
    CHECK(changes(x, 1000) == std::vector<int>{100 - delay, 200 + delay});
  }
}

TEST_CASE("cycles without a pause keep the radio on", "[smepp][SMP-23]") {
  energy x;
  x.set(0, {at_ms(0), 100ms, 60ms});
  x.set(1, {at_ms(50), 100ms, 60ms});
  CHECK(changes(x, 100'000).empty());
  CHECK(x.is_on(at_ms(77'777)));
  x.remove(1);
  x.set(2, {at_ms(0), 1s, 2s});
  CHECK(changes(x, 100'000).empty());
}

TEST_CASE("the radio is on exactly when some window asks for it", "[smepp][SMP-23][SMP-24]") {
  random_stream rng(11);
  const auto some = [&](int from, int to) {
    return from + static_cast<int>(rng.below(static_cast<std::uint64_t>(to - from)));
  };
  for (int round = 0; round < 60; ++round) {
    const int tolerance = some(0, 60);
    const int delay = some(0, 20);
    energy x({.tolerance = milliseconds(tolerance), .radio_delay = milliseconds(delay)});
    constexpr int length = 6000;
    std::vector<std::pair<int, int>> windows;
    for (int i = some(1, 5); i > 0; --i) {
      const int first = some(0, 500);
      const int period = some(100, 1500);
      const int size = some(1, 90);
      x.set(static_cast<energy::cycle_key>(i),
            {at_ms(first), milliseconds(period), milliseconds(size)});
      for (int begin = first; begin < length + 3000; begin += period)
        windows.emplace_back(begin, begin + size);
    }
    std::ranges::sort(windows);
    std::vector<bool> expected(length);
    int end = -1'000'000;
    for (const auto& [begin, until] : windows) {
      const bool merges = begin - end < tolerance;
      for (int t = (merges ? end : begin - delay); t < until + delay; ++t)
        if (t >= 0 && t < length)
          expected[static_cast<std::size_t>(t)] = true;
      end = std::max(end, until);
    }
    bool on = x.is_on(at_ms(0));
    auto next = x.next_change(at_ms(0));
    for (int t = 0; t < length; ++t) {
      if (next && at_ms(t) >= *next) {
        on = x.is_on(at_ms(t));
        next = x.next_change(at_ms(t));
      }
      REQUIRE(x.is_on(at_ms(t)) == on);
      REQUIRE(on == expected[static_cast<std::size_t>(t)]);
    }
  }
}
