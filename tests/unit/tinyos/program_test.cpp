#include <optional>
#include <vector>

#include "core/bytes.hpp"
#include "serial/meaning.hpp"
#include "support/catch.hpp"
#include "tinyos/program.hpp"

using namespace rubicon;
using namespace rubicon::tinyos;

namespace {

constexpr mote_id self{9};

program make(program_kind kind, duration every, duration first = 0s) {
  program_config x;
  x.kind = kind;
  x.every = every;
  return {x, self, instant(first)};
}

/// Lets it run to a moment, its transducer counting up from 1; each packet leaves at once.
struct driver {
  program of;
  std::uint16_t reading = 0;
  std::vector<packet> sent = {};
  std::vector<instant> at = {};
  bool leaves = true;

  void run_to(duration end) {
    while (of.deadline() <= instant(end)) {
      const auto now = of.deadline();
      if (auto x = of.on_time(now, [this] { return ++reading; })) {
        sent.push_back(*std::move(x));
        at.push_back(now);
        if (leaves)
          of.on_sent(true);
      }
    }
  }
};

/// Of Oscilloscope, with readings that nobody looks at.
bytes settings(std::uint16_t version, std::uint16_t interval, std::uint16_t count) {
  const auto high = [](std::uint16_t x) { return static_cast<std::uint8_t>(x >> 8U); };
  const auto low = [](std::uint16_t x) { return static_cast<std::uint8_t>(x & 0xffU); };
  bytes x{high(version), low(version), high(interval), low(interval), 0, 1,
          high(count),   low(count)};
  x.resize(28);
  return x;
}

} // namespace

TEST_CASE("ten readings are a packet of Oscilloscope", "[tinyos][GW-17]") {
  driver x{make(program_kind::oscilloscope, 500ms)};
  x.run_to(4999ms);
  CHECK(x.sent.empty()); // the packet goes with the tick after the tenth reading
  x.run_to(5s);
  REQUIRE(x.sent.size() == 1);
  CHECK(x.sent[0].am_type == 0x93);
  // Version, interval, address, count, and the readings.
  CHECK(x.sent[0].payload == bytes{0, 0, 0x01, 0xf4, 0, 9, 0, 0, 0, 1, 0, 2, 0, 3,
                                   0, 4, 0,    5,    0, 6, 0, 7, 0, 8, 0, 9, 0, 10});
  x.run_to(10s);
  REQUIRE(x.sent.size() == 2);
  CHECK(x.sent[1].payload.at(7) == 1); // the count
  CHECK(x.sent[1].payload.at(9) == 11);
  CHECK(x.of.counters().packets == 2);
  CHECK(serial::meaning_of({0xffff, 9, 0x22, x.sent[1].am_type, x.sent[1].payload})
            .starts_with("mote 9"));
}

TEST_CASE("an oscilloscope takes the interval of a higher version", "[tinyos][GW-17]") {
  driver x{make(program_kind::oscilloscope, 500ms)};
  x.run_to(2s);
  x.of.on_packet(0x93, settings(0, 100, 0), instant(2s));
  CHECK(x.of.interval() == 500ms); // it is not higher
  x.of.on_packet(0x93, settings(3, 100, 0), instant(2s));
  CHECK(x.of.interval() == 100ms);
  CHECK(x.of.version() == 3);
  CHECK(x.of.counters().settings == 1);
  x.of.on_packet(0x93, settings(2, 700, 0), instant(2s));
  CHECK(x.of.interval() == 100ms);
  x.run_to(3099ms);
  CHECK(x.sent.empty()); // its readings have begun anew
  x.run_to(3100ms);
  REQUIRE(x.sent.size() == 1);
  CHECK(bytes(x.sent[0].payload.begin(), x.sent[0].payload.begin() + 4) == bytes{0, 3, 0, 100});
  x.of.on_packet(0x93, settings(4, 0, 0), instant(3100ms));
  CHECK(x.of.interval() == 1ms); // a timer of 0 would never end
}

TEST_CASE("an oscilloscope takes over a higher count", "[tinyos][GW-17]") {
  driver x{make(program_kind::oscilloscope, 10ms)};
  x.of.on_packet(0x93, settings(0, 0, 40), instant{});
  x.run_to(300ms);
  REQUIRE(x.sent.size() == 3);
  CHECK(x.sent[0].payload.at(7) == 40);
  CHECK(x.sent[1].payload.at(7) == 40); // which the first packet does not add to
  CHECK(x.sent[2].payload.at(7) == 41);
  x.of.on_packet(0x93, settings(0, 0, 7), instant(300ms));
  x.run_to(400ms);
  CHECK(x.sent.back().payload.at(7) == 42);
}

TEST_CASE("BlinkToRadio sends its address and a count", "[tinyos][GW-17]") {
  driver x{make(program_kind::blink, 250ms, 100ms)};
  x.run_to(600ms);
  REQUIRE(x.sent.size() == 3);
  CHECK(x.at[0] == instant(100ms));
  CHECK(x.at[2] == instant(600ms));
  CHECK(x.sent[0] == packet{6, bytes{0, 9, 0, 1}});
  CHECK(x.sent[2] == packet{6, bytes{0, 9, 0, 3}});
  x.of.on_packet(6, bytes{0, 4, 0x12, 0x0d}, instant(600ms));
  CHECK(int{x.of.leds()} == 5);
  x.of.on_packet(6, bytes{0, 1}, instant(600ms)); // of RadioCountToLeds
  CHECK(int{x.of.leds()} == 5);
  CHECK(x.of.counters().received == 1);
  CHECK(x.of.counters().ignored == 1);
}

TEST_CASE("RadioCountToLeds sends a count", "[tinyos][GW-17]") {
  driver x{make(program_kind::count, 250ms)};
  x.run_to(250ms);
  REQUIRE(x.sent.size() == 2);
  CHECK(x.sent[1] == packet{6, bytes{0, 2}});
  x.of.on_packet(6, bytes{0, 6}, instant(250ms));
  CHECK(int{x.of.leds()} == 6);
  x.of.on_packet(7, bytes{0, 1}, instant(250ms)); // not its AM type
  x.of.on_packet(6, {}, instant(250ms));
  CHECK(int{x.of.leds()} == 6);
  CHECK(x.of.counters().received == 1);
  CHECK(x.of.counters().ignored == 1);
}

TEST_CASE("while a packet is at the radio others are left out", "[tinyos][GW-17]") {
  driver x{make(program_kind::count, 250ms)};
  x.leaves = false;
  x.run_to(1s);
  CHECK(x.sent.size() == 1);
  CHECK(x.of.counters().radio_busy == 4);
  x.of.on_sent(false);
  CHECK(x.of.counters().unsent == 1);
  x.run_to(1250ms);
  REQUIRE(x.sent.size() == 2);
  CHECK(x.sent[1].payload == bytes{0, 6}); // it has counted meanwhile
}

TEST_CASE("a late caller gets one packet, not all that were missed", "[tinyos]") {
  auto x = make(program_kind::count, 10ms);
  CHECK(x.on_time(instant(1s), {}));
  CHECK(x.deadline() == instant(1s)); // once more, and from then on in its pace
  x.on_sent(true);
  CHECK(x.on_time(instant(1s), {}));
  CHECK(x.deadline() == instant(1010ms));
  CHECK(!x.on_time(instant(1009ms), {}));
}
