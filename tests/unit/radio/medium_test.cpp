#include <map>
#include <string>

#include "radio/medium/medium.hpp"
#include "radio/parameters.hpp"
#include "support/catch.hpp"
#include "unit/radio/samples.hpp"

using namespace rubicon;
using namespace rubicon::radio;
using test::disk;
using test::frame_for;

namespace {

constexpr radio_index a{0};
constexpr radio_index b{1};
constexpr radio_index c{2};
constexpr radio_index d{3};

std::string_view name_of(outcome x) {
  switch (x) {
  case outcome::intact:
    return "intact";
  case outcome::weak:
    return "weak";
  case outcome::captured:
    return "captured";
  case outcome::collision:
    return "collision";
  case outcome::half_duplex:
    return "half_duplex";
  case outcome::off:
    return "off";
  }
  return "";
}

/// a - b - c - d: each hears its neighbours in the row only.
struct row {
  row() {
    for (std::uint16_t i = 0; i < 4; ++i) {
      places.add({{island_id{1}, mote_id{i}}, {10.0 * i, 0, 0}, 0});
      air.add({}, energy_meter(find_platform("micaz"), 2000, 0, instant{}), instant{});
    }
  }

  slot_index start(radio_index from, duration at, duration length = 1ms) {
    transmission x;
    x.from = from;
    x.begin = instant(at);
    x.length = length;
    return air.start(x, places.around(from));
  }

  /// What the end of a frame yields: receiver and outcome, in order.
  std::string end(slot_index slot, duration at) {
    std::string all;
    std::size_t expected = 0;
    air.end(slot, instant(at), rng,
            [&](const transmission&, std::size_t place, const hearer& x, outcome y) {
              CHECK(place == expected++);
              all += "abcd"[x.radio.value] + (":" + std::string(name_of(y))) + ' ';
            });
    return all;
  }

  [[nodiscard]] radio_state state(radio_index x) const { return air.meter(x).state(); }

  /// Whether it has a frame coming in right after `at`.
  [[nodiscard]] bool receives(radio_index x, duration at) const {
    const auto grown =
        air.times(x, instant(at + 1ns)).radio_receive - air.times(x, instant(at)).radio_receive;
    return grown == 1ns;
  }

  topology places{disk(10), 0};
  medium air{disk(10)};
  random_stream rng{1};
};

} // namespace

TEST_CASE("a lone frame reaches all in range and no other", "[radio][medium]") {
  row x;
  const auto slot = x.start(b, 1ms);
  CHECK(x.receives(a, 1ms));
  CHECK(x.state(b) == radio_state::transmit);
  CHECK(x.receives(c, 1ms));
  CHECK_FALSE(x.receives(d, 1ms));
  CHECK(x.air.sending(b) == slot);
  CHECK(x.end(slot, 2ms) == "a:intact c:intact ");
  for (const auto radio : {a, b, c, d}) {
    CHECK(x.state(radio) == radio_state::listen);
    CHECK_FALSE(x.receives(radio, 2ms));
  }
  const auto times = x.air.times(a, instant(3ms));
  CHECK(times.radio_receive == 1ms);
  CHECK(times.radio_listen == 2ms);
  CHECK_FALSE(x.air.sending(b));
  CHECK(x.air.copies() == 2);
}

TEST_CASE("frames that overlap at a receiver destroy each other there only",
          "[radio][medium][NET-15]") {
  row x;
  const auto first = x.start(a, 1ms);
  const auto second = x.start(c, 2ms); // hidden from a
  CHECK(x.receives(b, 2ms));           // still locked on the first
  CHECK(x.end(first, 3ms) == "b:collision ");
  CHECK(x.receives(b, 3ms)); // of the second there is a carrier still, though nothing to be had
  CHECK(x.end(second, 4ms) == "b:collision d:intact ");
}

TEST_CASE("a carrier is sensed to the end of the last frame that overlaps", "[radio][medium]") {
  auto config = disk(10);
  config.sensing = sensing::carrier;
  config.window = sensing_window::end;
  row x;
  x.air = medium(config);
  for (int i = 0; i < 4; ++i)
    x.air.add({}, energy_meter(find_platform("micaz"), 2000, 0, instant{}), instant{});
  const auto first = x.start(a, 1ms, GENERATE(1ms, 3ms));
  const auto second = x.start(c, 1500us, 3500us - x.air.content(first).length);
  const auto ends = instant(1ms) + x.air.content(first).length;
  const auto [sooner, later] =
      ends < instant(3ms) ? std::pair(first, second) : std::pair(second, first);
  CHECK(x.end(sooner, 2ms).starts_with("b:collision "));
  CHECK(x.receives(b, 2ms));
  CHECK_FALSE(x.air.clear(b, instant(2500us)));
  CHECK(x.end(later, 4ms).starts_with("b:collision "));
  CHECK(x.air.clear(b, instant(4200us)));
}

TEST_CASE("who has sent is ready to receive a turnaround later", "[radio][medium][NET-15]") {
  row x;
  CHECK(x.end(x.start(b, 1ms), 2ms) == "a:intact c:intact ");
  const auto early = x.start(a, 2ms + 191us);
  CHECK(x.end(early, 4ms) == "b:half_duplex ");
  CHECK(x.end(x.start(b, 5ms), 6ms) == "a:intact c:intact ");
  const auto ack = x.start(a, 6ms + 192us);
  CHECK(x.end(ack, 7ms) == "b:intact ");
  CHECK(x.end(x.start(b, 8ms), 9ms) == "a:intact c:intact ");
  const auto ahead = x.start(a, 9ms + 100us);
  const auto late = x.start(c, 9ms + 300us); // into the rest of the first
  CHECK(x.end(ahead, 10ms) == "b:half_duplex ");
  CHECK(x.end(late, 11ms) == "b:collision d:intact ");
}

TEST_CASE("back to back is no overlap", "[radio][medium]") {
  row x;
  const auto first = x.start(a, 1ms);
  CHECK(x.end(first, 2ms) == "b:intact ");
  const auto second = x.start(c, 2ms);
  CHECK(x.end(second, 3ms) == "b:intact d:intact ");
}

TEST_CASE("a third frame over the rest of a collision is destroyed too", "[radio][medium]") {
  row x;
  const auto first = x.start(a, 1ms);
  const auto second = x.start(c, 2ms);
  CHECK(x.end(first, 3ms) == "b:collision ");
  const auto third = x.start(a, 4ms);
  CHECK(x.end(second, 5ms) == "b:collision d:intact ");
  CHECK(x.end(third, 6ms) == "b:collision ");
}

TEST_CASE("a radio receives nothing of a frame while it sends itself", "[radio][medium]") {
  row x;
  SECTION("it was sending when the frame began") {
    const auto own = x.start(b, 1ms);
    const auto other = x.start(c, 2ms);
    CHECK(x.end(own, 3ms) == "a:intact c:half_duplex ");
    CHECK(x.end(other, 4ms) == "b:half_duplex d:intact ");
  }
  SECTION("it began to send during the frame") {
    const auto other = x.start(c, 1ms);
    const auto own = x.start(b, 2ms);
    CHECK(x.state(b) == radio_state::transmit);
    CHECK(x.end(own, 3ms) == "a:intact c:half_duplex ");
    CHECK(x.state(b) == radio_state::listen);
    CHECK(x.end(other, 4ms) == "b:half_duplex d:intact ");
  }
  SECTION("what spoiled a copy first stays its cause") {
    const auto first = x.start(a, 1ms);
    const auto second = x.start(c, 2ms);
    const auto own = x.start(b, 3ms);
    CHECK(x.end(first, 4ms) == "b:collision ");
    CHECK(x.end(second, 5ms) == "b:collision d:intact ");
    CHECK(x.end(own, 6ms) == "a:half_duplex c:half_duplex ");
  }
}

TEST_CASE("a radio that is off at any time of a frame misses it", "[radio][medium]") {
  row x;
  SECTION("off from before") {
    x.air.switch_off(b, instant(1ms));
    const auto slot = x.start(a, 2ms);
    CHECK(x.state(b) == radio_state::off);
    CHECK(x.end(slot, 3ms) == "b:off ");
  }
  SECTION("switched off and on again meanwhile") {
    const auto slot = x.start(a, 1ms);
    x.air.switch_off(b, instant(1ms + 1us));
    x.air.switch_on(b, instant(1ms + 2us));
    CHECK(x.state(b) == radio_state::listen);
    CHECK(x.end(slot, 3ms) == "b:off ");
  }
  SECTION("switched on meanwhile, it hears that the channel is busy") {
    x.air.switch_off(b, instant(1ms));
    const auto slot = x.start(a, 2ms);
    x.air.switch_on(b, instant(2100us));
    CHECK_FALSE(x.air.clear(b, instant(2200us)));
    const auto second = x.start(c, 2300us);
    CHECK(x.end(slot, 3ms) == "b:off ");
    CHECK(x.end(second, 4ms) == "b:collision d:intact ");
  }
}

TEST_CASE("a frame cut short is lost to all who would have had it", "[radio][medium]") {
  row x;
  const auto hidden = x.start(d, 1ms);
  const auto slot = x.start(b, 2ms);
  x.air.cut(slot);
  CHECK(x.end(slot, 3ms) == "a:off c:collision ");
  CHECK(x.end(hidden, 4ms) == "c:collision ");
}

TEST_CASE("the channel is clear once nothing has been heard or sent for a while",
          "[radio][medium]") {
  row x;
  CHECK(x.air.clear(b, instant(1ms)));
  const auto slot = x.start(a, 1ms);
  CHECK_FALSE(x.air.clear(a, instant(1500us)));
  CHECK_FALSE(x.air.clear(b, instant(1500us)));
  CHECK(x.air.clear(c, instant(1500us))); // out of range
  x.end(slot, 2ms);
  CHECK_FALSE(x.air.clear(b, instant(2128us - 1ns)));
  CHECK(x.air.clear(b, instant(2128us)));
  // What has sent hears nothing for 192 us more.
  CHECK_FALSE(x.air.clear(a, instant(2192us + 128us - 1ns)));
  CHECK_FALSE(x.air.stays_clear(a, instant(2192us + 128us - 1ns)));
  CHECK(x.air.clear(a, instant(2192us + 128us)));
  CHECK(x.air.stays_clear(a, instant(2192us + 128us)));
}

TEST_CASE("slots are used again and distinguish their uses", "[radio][medium]") {
  row x;
  const auto first = x.start(a, 1ms);
  const auto stamp = x.air.stamp(first);
  x.end(first, 2ms);
  CHECK(x.air.stamp(first) != stamp);
  const auto second = x.start(c, 3ms);
  CHECK(second == first);
  CHECK(x.air.stamp(second) != stamp);
}

TEST_CASE("the filter passes own and broadcast frames of the own PAN", "[radio][medium][RTG-06]") {
  struct passing {
    std::uint16_t destination;
    std::uint16_t pan;
    bool own;
    bool any;
  };
  for (const auto& [destination, pan, own, any] : {passing{7, 1, true, true},
                                                   {0xffff, 1, true, true},
                                                   {8, 1, false, true},
                                                   {7, 2, false, true},
                                                   {0xffff, 2, false, true},
                                                   {8, 2, false, true},
                                                   {7, 0xffff, false, true}}) {
    INFO(destination << " in " << pan);
    for (const bool promiscuous : {false, true}) {
      medium x;
      transceiver_config config;
      config.address = mote_id{7};
      config.pan = 1;
      config.promiscuous = promiscuous;
      x.add(std::move(config), energy_meter(find_platform("micaz"), 2000, 0, instant{}), instant{});
      CHECK(x.wanted(a, frame_for(destination, pan)) == (promiscuous ? any : own));
      CHECK(x.addressed(a, frame_for(destination, pan)) == (destination == 7 && pan == 1));
    }
  }
}

TEST_CASE("a radio waits for an ack or does not, whatever else it is", "[radio][medium]") {
  row x;
  CHECK_FALSE(x.air.awaits_ack(b));
  x.air.await_ack(b, true);
  CHECK(x.air.awaits_ack(b));
  CHECK_FALSE(x.air.awaits_ack(c));
  x.start(a, 1ms);
  CHECK(x.air.awaits_ack(b));
  x.air.await_ack(b, false);
  CHECK_FALSE(x.air.awaits_ack(b));
}
