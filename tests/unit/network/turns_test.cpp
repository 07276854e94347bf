// How a tick is divided, and when frames without a slot leave (SYN-16).
#include <set>

#include "network/clock/clock_sync.hpp"
#include "network/clock/tick_plan.hpp"
#include "network/slot_time.hpp"
#include "network/turns.hpp"
#include "support/catch.hpp"

namespace rubicon::network {

namespace {

/// A sink's clock that runs: island time is its own, ticks are multiples of the period.
clock_sync running_clock(std::chrono::milliseconds period = std::chrono::milliseconds{500}) {
  clock_sync_config config;
  config.self = mote_id{1};
  config.is_root = true;
  config.resume_wait = 0s;
  config.tick.period = period;
  clock_sync x(config, instant{});
  static_cast<void>(x.on_time(instant{}));
  return x;
}

turns of_mote(std::uint64_t seed) {
  return {false, {}, random_stream(seed)};
}

} // namespace

TEST_CASE("a tick of 500 ms has 400 units for slots, and a fifth without any",
          "[network][SYN-16]") {
  const tick_plan plan(500ms);
  CHECK(plan.units() == 400);
  CHECK(plan.begin({0, 400}) == 0ms);
  CHECK(plan.begin({100, 3}) == 100ms);
  CHECK(plan.begin({399, 1}) == 399ms);
  CHECK_FALSE(plan.begin({399, 2}).has_value());
  CHECK_FALSE(plan.begin({}).has_value());
  CHECK(plan.free_from(7) == 400ms);
  CHECK(plan.free_until() == 480ms);
}

TEST_CASE("all slots in use lie before the free part, and not many others", "[network][SYN-16]") {
  for (const auto period : {80ms, 100ms, 200ms, 500ms, 1000ms}) {
    const tick_plan plan(period);
    CHECK(plan.share_of(0) == 0);
    CHECK(plan.share_of(1) == 1);
    CHECK(plan.share_of(10'000) == 7);
    for (std::size_t used = 1; used <= plan.units(); ++used) {
      const auto end = plan.free_from(plan.share_of(used));
      const auto last = static_cast<duration::rep>(used) * plan.unit;
      CHECK(end >= last);
      CHECK(end < last + period / 5);
      CHECK(end <= plan.free_until());
    }
  }
}

TEST_CASE("a shorter tick has fewer units, a very short one no free part", "[network][SYN-16]") {
  CHECK(tick_plan(200ms).units() == 160);
  CHECK(tick_plan(100ms).units() == 60); // not less than 40 ms are free
  CHECK(tick_plan(80ms).units() == 40);
  CHECK(tick_plan(80ms).has_free_part());
  CHECK(tick_plan(79ms).units() == 79);
  CHECK_FALSE(tick_plan(79ms).has_free_part());
  CHECK(tick_plan(1ms).units() == 1);
}

TEST_CASE("a slot is as long as its packets need over all their hops", "[network][SYN-16]") {
  const access_times standard;
  // 46 octets of ten values, a channel's 6 and 19 of headers: 71 octets of 32 us, and the exchange
  CHECK(exchange_time(46 + 6, standard) == 71 * 32us + 864us);
  CHECK(passage(46, 1, standard) == 71 * 32us + 864us + 640us);
  CHECK(units_for(passage(46, 1, standard), standard) == 4);
  // each further hop turns back from its ack and has a back-off, too
  CHECK(passage(106, 8, standard) == 8 * (131 * 32us + 864us) + 7 * (192us + 2240us) + 640us);
  CHECK(passage_up(46, standard) == 89 * 32us + 864us + 640us);
  CHECK(passage_up(106, standard) == 2 * (96 * 32us + 864us + 640us)); // cut in two
  CHECK(units_for(0ns, standard) == 0);
  CHECK(units_for(1h, standard) == 0xffff);
}

TEST_CASE("no frame waits for a turn while no slots are in use", "[network][SYN-16]") {
  auto x = of_mote(1);
  auto clock = running_clock();
  for (auto now = instant{}; now < instant{1s}; now += 7ms)
    CHECK(x.next(now, clock.time()) == now);
  CHECK(x.longest(instant{}, clock.time()) == 0s);
  clock.use_slots(7, instant{});
  CHECK(x.next(instant{1s}, clock.time()) > instant{1s});
  CHECK(x.longest(instant{}, clock.time()) == 500ms);
  CHECK(x.next(instant{1s}, time_estimate()) == instant{1s}); // does not know the time
  auto hasty = running_clock(std::chrono::milliseconds{60});
  hasty.use_slots(7, instant{});
  CHECK(x.next(instant{1s}, hasty.time()) == instant{1s});
}

TEST_CASE("where slots are in use other frames leave in the free part, spread out",
          "[network][SYN-16]") {
  auto clock = running_clock();
  clock.use_slots(7, instant{});
  std::set<duration> begins;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    auto x = of_mote(seed);
    for (duration tick{}; tick < 5s; tick += 500ms) {
      const auto from = instant(tick) + 400ms;
      const auto begin = x.next(instant(tick), clock.time());
      CHECK(begin >= from);
      CHECK(begin < from + 40ms);
      begins.insert(begin - from);
      CHECK(x.next(instant(tick) + 399ms, clock.time()) ==
            begin); // the same for all that waits here
      CHECK(x.next(from + 40ms, clock.time()) == from + 40ms);
      CHECK(x.next(from + 79ms, clock.time()) == from + 79ms);
      CHECK(x.next(from + 80ms, clock.time()) >= from + 500ms); // too late for a long frame
    }
  }
  CHECK(begins.size() > 900);
  turns sink(true, {}, random_stream(1));
  CHECK(sink.next(instant{7s}, clock.time()) == instant{7s} + 400ms);
}

TEST_CASE("the fewer slots are in use, the earlier the free part begins", "[network][SYN-16]") {
  auto clock = running_clock();
  clock.use_slots(1, instant{});
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    auto x = of_mote(seed);
    const auto begin = x.next(instant{1s}, clock.time());
    CHECK(begin >= instant{1s} + 58ms);
    CHECK(begin < instant{1s} + 120ms); // nobody has waited for longer than 60 ms
    CHECK(x.next(instant{1s} + 479ms, clock.time()) == instant{1s} + 479ms);
  }
}

TEST_CASE("before the first tick of a setting there are turns too", "[network][SYN-16]") {
  auto clock = running_clock();
  clock.set_tick({1000, island_time(std::chrono::seconds(100)), std::chrono::milliseconds(500)},
                 instant{});
  clock.use_slots(7, instant{});
  auto x = of_mote(1);
  const auto begin = x.next(instant{99s} + 700ms, clock.time());
  CHECK(begin >= instant{99s} + 900ms);
  CHECK(begin < instant{99s} + 940ms);
}

} // namespace rubicon::network
