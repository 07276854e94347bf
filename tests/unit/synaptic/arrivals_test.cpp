#include "support/catch.hpp"
#include "synaptic/arrivals.hpp"

using namespace rubicon::synaptic;
using report = arrivals::report;
using verdict = arrivals::verdict;

namespace {

vector_message whole(std::uint32_t tick) {
  const auto x = static_cast<float>(tick);
  return {tick, 0, {x, x + 0.5F}};
}

/// An in end that has shown the vector of tick 9, at tick 10.
arrivals running() {
  arrivals x(2, 1);
  static_cast<void>(x.put(whole(9), 9));
  static_cast<void>(x.on_tick(10));
  return x;
}

} // namespace

TEST_CASE("a vector is shown at the tick after its own, whole", "[synaptic][SYN-10]") {
  auto x = running();
  CHECK(x.shown()[0] == 9);
  CHECK(x.put({10, 1, {7}}, 10) == verdict::taken);
  CHECK(x.shown()[1] == 9.5F);
  CHECK(x.put({10, 0, {6}}, 10) == verdict::taken);
  CHECK(x.shown()[0] == 9);
  CHECK(x.on_tick(11) == report::updated);
  CHECK(x.shown()[0] == 6);
  CHECK(x.shown()[1] == 7);
}

TEST_CASE("a vector that misses a part is missed, and the old values stay", "[synaptic][SYN-10]") {
  auto x = running();
  CHECK(x.put({10, 1, {7}}, 10) == verdict::taken);
  CHECK(x.on_tick(11) == report::missed);
  CHECK(x.shown()[0] == 9);
  CHECK(x.shown()[1] == 9.5F);
}

TEST_CASE("nothing is reported before the first vector", "[synaptic][SYN-10]") {
  arrivals x(2, 1);
  CHECK(x.on_tick(1) == report::none);
  CHECK(x.shown()[1] == 0);
  CHECK(x.put(whole(1), {}) == verdict::untimely);
  CHECK(x.on_tick(2) == report::none);
  CHECK(x.put(whole(3), 2) == verdict::taken); // the out end is ahead
  CHECK(x.on_tick(3) == report::none);
  CHECK(x.on_tick(4) == report::updated);
}

TEST_CASE("a vector that is early changes nothing before its tick is over",
          "[synaptic][SYN-10][SYN-11]") {
  auto x = running();
  CHECK(x.put(whole(10), 10) == verdict::taken);
  CHECK(x.put(whole(11), 10) == verdict::taken);
  CHECK(x.put(whole(12), 10) == verdict::untimely);
  CHECK(x.on_tick(11) == report::updated);
  CHECK(x.shown()[0] == 10);
  CHECK(x.on_tick(12) == report::updated);
  CHECK(x.shown()[0] == 11);
  CHECK(x.on_tick(13) == report::missed);
}

TEST_CASE("a late vector is shown at the next tick unless a newer one is", "[synaptic][SYN-10]") {
  auto x = running();
  CHECK(x.on_tick(11) == report::missed);
  CHECK(x.put(whole(10), 11) == verdict::late);
  CHECK(x.shown()[0] == 9);
  SECTION("there is none newer") {
    CHECK(x.on_tick(12) == report::missed);
    CHECK(x.shown()[0] == 10);
  }
  SECTION("the one due has come") {
    CHECK(x.put(whole(11), 11) == verdict::taken);
    CHECK(x.on_tick(12) == report::updated);
    CHECK(x.shown()[0] == 11);
    CHECK(x.put(whole(10), 12) == verdict::late);
    CHECK(x.on_tick(13) == report::missed);
    CHECK(x.shown()[0] == 11);
  }
}

TEST_CASE("what comes twice is not taken twice", "[synaptic][SYN-10]") {
  auto x = running();
  CHECK(x.put(whole(9), 10) == verdict::repeated);
  CHECK(x.put({10, 0, {1}}, 10) == verdict::taken);
  CHECK(x.put({10, 0, {2}}, 10) == verdict::repeated);
  CHECK(x.put({10, 0, {3, 4}}, 10) == verdict::taken);
  CHECK(x.put(whole(10), 10) == verdict::repeated);
  CHECK(x.on_tick(11) == report::updated);
  CHECK(x.shown()[0] == 1);
  CHECK(x.shown()[1] == 4);
}

TEST_CASE("a stopped out end is not missed", "[synaptic][SYN-07][SYN-10]") {
  auto x = running();
  SECTION("its last vector has come") {
    CHECK(x.put(whole(10), 10) == verdict::taken);
    x.stop(10, 10);
    CHECK(x.on_tick(11) == report::updated);
  }
  SECTION("its last vector has not") {
    x.stop(10, 10);
    CHECK(x.on_tick(11) == report::missed);
  }
  SECTION("we have not been told for a while") {
    CHECK(x.on_tick(11) == report::missed);
    CHECK(x.on_tick(12) == report::missed);
    x.stop(10, 12);
    CHECK(x.on_tick(13) == report::none);
  }
  for (std::uint32_t tick = 13; tick < 20; ++tick)
    CHECK(x.on_tick(tick) == report::none);
  CHECK(x.put(whole(20), 20) == verdict::taken);
  x.stop(10, 20); // an old word
  CHECK(x.on_tick(21) == report::updated);
  CHECK(x.on_tick(22) == report::missed);
}

TEST_CASE("a stop that overtakes the first vector counts too", "[synaptic][SYN-07]") {
  arrivals x(2, 1);
  static_cast<void>(x.on_tick(10));
  x.stop(10, 10);
  CHECK(x.put(whole(10), 10) == verdict::taken);
  CHECK(x.on_tick(11) == report::updated);
  CHECK(x.on_tick(12) == report::none);
}

TEST_CASE("with a divisor only its ticks count", "[synaptic][SYN-13]") {
  arrivals x(2, 3);
  CHECK(x.put(whole(10), 9) == verdict::untimely);
  CHECK(x.put(whole(9), 9) == verdict::taken);
  CHECK(x.on_tick(10) == report::updated);
  CHECK(x.on_tick(11) == report::none);
  CHECK(x.put(whole(12), 11) == verdict::taken);
  CHECK(x.on_tick(12) == report::none);
  CHECK(x.shown()[0] == 9);
  CHECK(x.on_tick(13) == report::updated);
  CHECK(x.on_tick(14) == report::none);
  CHECK(x.on_tick(15) == report::none);
  CHECK(x.on_tick(16) == report::missed);
}

TEST_CASE("a leap begins anew", "[synaptic][SYN-10][CLK-05]") {
  auto x = running();
  const auto tick = GENERATE(3U, 11U, 1000U, 4000000000U);
  CHECK(x.put(whole(10), 10) == verdict::taken);
  x.on_leap(tick);
  CHECK(x.put(whole(tick), tick) == verdict::taken);
  CHECK(x.on_tick(tick + 1) == report::updated);
  CHECK(x.on_tick(tick + 2) == report::missed);
  x.stop(tick + 500, tick + 2); // the out end has not leapt yet
  CHECK(x.on_tick(tick + 3) == report::none);
}

TEST_CASE("a leap after the stop does not wake the in end", "[synaptic][CLK-05]") {
  auto x = running();
  x.stop(9, 10);
  x.on_leap(5);
  CHECK(x.on_tick(6) == report::none);
  CHECK(x.put(whole(6), 6) == verdict::taken);
  CHECK(x.on_tick(7) == report::updated);
}

TEST_CASE("silence is ticks missed in a row with nothing heard", "[synaptic][SYN-17]") {
  auto x = running();
  CHECK(x.silence() == 0);
  static_cast<void>(x.on_tick(11));
  static_cast<void>(x.on_tick(12));
  CHECK(x.silence() == 2);
  static_cast<void>(x.put({12, 0, {1}}, 12)); // a part: still missed, but somebody is there
  CHECK(x.on_tick(13) == report::missed);
  CHECK(x.silence() == 0);
}

TEST_CASE("T may wrap around", "[synaptic][SYN-11]") {
  arrivals x(2, 1);
  for (std::uint32_t tick = 0xfffffffd; tick != 4; ++tick) {
    CHECK(x.on_tick(tick) == (tick == 0xfffffffd ? report::none : report::updated));
    CHECK(x.put(whole(tick), tick) == verdict::taken);
  }
}
