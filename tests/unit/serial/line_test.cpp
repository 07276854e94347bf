#include "serial/cable/line.hpp"

#include "support/catch.hpp"
#include "unit/serial/fixture.hpp"

using namespace rubicon;
using namespace rubicon::serial;
using serial::test::start;

namespace {

line make_line(line_config config = {}, std::uint64_t seed = 1) {
  return {config, random_stream(seed)};
}

payload octets(std::size_t count, std::uint8_t value = 0x55) {
  return bytes(count, value);
}

void check_balance(const line& x) {
  for (const auto towards : {direction::to_pc, direction::to_mote}) {
    const auto& counters = x.counters(towards);
    CHECK(counters.written ==
          counters.arrived + counters.overflow + counters.unplugged + x.in_flight(towards));
  }
}

} // namespace

TEST_CASE("octets take ten bit times each", "[serial][GW-01]") {
  struct row {
    std::uint32_t baud;
    duration time; ///< of 41 octets, tinyos.md 1.5
  };
  for (const auto& row :
       {row{57600, 7118us + 55ns}, row{115200, 3559us + 27ns}, row{19200, 21354us + 166ns}}) {
    CAPTURE(row.baud);
    line_config config;
    config.baud = row.baud;
    auto cable = make_line(config);
    CHECK_FALSE(cable.deadline());
    cable.send(direction::to_pc, octets(41), start);
    REQUIRE(cable.deadline());
    CHECK(*cable.deadline() - start == row.time);
    CHECK(cable.on_time(*cable.deadline() - 1ns).empty());
    const auto out = cable.on_time(*cable.deadline());
    REQUIRE(out.size() == 1);
    CHECK(out[0].towards == direction::to_pc);
    CHECK(out[0].octets == octets(41));
    CHECK_FALSE(cable.deadline());
  }
}

TEST_CASE("chunks of one direction queue up and keep their order", "[serial][GW-01]") {
  auto cable = make_line();
  for (std::uint8_t i = 0; i < 10; ++i)
    cable.send(direction::to_mote, octets(10, i), start);
  cable.send(direction::to_pc, octets(10, 99), start); // the other direction does not wait
  const auto one = transmission_time(10, 57600);
  const auto early = cable.on_time(start + one);
  REQUIRE(early.size() == 2);
  CHECK(early[0].towards == direction::to_pc);
  CHECK(early[1].octets == octets(10, 0));
  const auto later = cable.on_time(start + 10 * one);
  REQUIRE(later.size() == 9);
  for (std::uint8_t i = 0; i < 9; ++i)
    CHECK(later[i].octets == octets(10, static_cast<std::uint8_t>(i + 1)));
  check_balance(cable);
}

TEST_CASE("a full buffer loses the octets beyond it and counts them", "[serial][GW-01][NFR-03]") {
  line_config config;
  config.buffer = 100;
  auto cable = make_line(config);
  cable.send(direction::to_pc, octets(60), start);
  cable.send(direction::to_pc, octets(40), start);
  CHECK(cable.counters(direction::to_pc).overflow == 0); // exactly full
  cable.send(direction::to_pc, octets(1), start);
  CHECK(cable.counters(direction::to_pc).overflow == 1);
  cable.send(direction::to_pc, octets(30), start + transmission_time(20, config.baud));
  CHECK(cable.counters(direction::to_pc).overflow == 1 + 10); // twenty had left
  const auto out = cable.on_time(start + 1s);
  REQUIRE(out.size() == 3);
  CHECK(out[2].octets.size() == 20);
  check_balance(cable);
}

TEST_CASE("the buffer empties at line speed at every baud rate", "[serial][GW-01]") {
  for (const std::uint32_t baud : {300U, 19200U, 57600U, 115200U, 921600U}) {
    CAPTURE(baud);
    line_config config;
    config.baud = baud;
    auto cable = make_line(config);
    cable.send(direction::to_pc, octets(config.buffer), start);
    for (std::size_t gone = 1; gone < config.buffer; gone += 97) {
      auto copy = cable;
      copy.send(direction::to_pc, octets(gone + 1), start + transmission_time(gone, baud) + 1ns);
      REQUIRE(copy.counters(direction::to_pc).overflow == 1);
    }
  }
}

TEST_CASE("an unplugged cable loses what is in flight and what is written", "[serial][GW-01]") {
  auto cable = make_line();
  cable.send(direction::to_pc, octets(10), start);
  cable.send(direction::to_pc, octets(2000), start);
  cable.send(direction::to_mote, octets(7), start);
  const auto first = start + transmission_time(10, 57600);
  const auto out = cable.unplug(first); // what has arrived by then counts as arrived
  CHECK(out.size() == 2);
  CHECK_FALSE(cable.plugged());
  CHECK_FALSE(cable.deadline());
  cable.send(direction::to_mote, octets(5), first + 1ms);
  CHECK_FALSE(cable.deadline());
  CHECK(cable.counters(direction::to_pc).unplugged == 2000);
  CHECK(cable.counters(direction::to_mote).unplugged == 5);
  cable.plug();
  cable.send(direction::to_mote, octets(5), first + 2ms);
  CHECK(cable.deadline() == first + 2ms + transmission_time(5, 57600));
  cable.send(direction::to_pc, octets(5), first + 2ms); // does not wait for what was lost
  CHECK(cable.on_time(first + 2ms + transmission_time(5, 57600)).size() == 2);
  check_balance(cable);
}

TEST_CASE("octets are corrupted at the configured rate, never into themselves", "[serial][GW-01]") {
  for (const double rate : {0.001, 0.01, 0.1}) {
    CAPTURE(rate);
    line_config config;
    config.octet_error = rate;
    config.buffer = 1'000'000;
    auto cable = make_line(config, 7);
    constexpr std::size_t count = 200'000;
    const auto original = octets(count);
    cable.send(direction::to_pc, original, start);
    const auto out = cable.on_time(start + 1h);
    REQUIRE(out.size() == 1);
    REQUIRE(out[0].octets.size() == count);
    std::size_t changed = 0;
    for (const auto octet : out[0].octets.view())
      changed += octet != 0x55 ? 1 : 0;
    CHECK(changed == cable.counters(direction::to_pc).corrupted);
    CHECK(static_cast<double>(changed) == Approx(rate * count).epsilon(0.15));
    CHECK(original == octets(count)); // the writer's octets are not touched
  }
}

TEST_CASE("a line without errors passes octets on without copying them", "[serial][GW-01]") {
  auto cable = make_line();
  const auto original = octets(100);
  cable.send(direction::to_mote, original, start);
  const auto out = cable.on_time(start + 1s);
  REQUIRE(out.size() == 1);
  CHECK(out[0].octets.view().data() == original.view().data());
}

TEST_CASE("a line with the same seed corrupts the same octets", "[serial][GW-01]") {
  const auto run = [](std::uint64_t seed) {
    line_config config;
    config.octet_error = 0.05;
    auto cable = make_line(config, seed);
    for (int i = 0; i < 20; ++i)
      cable.send(i % 2 == 0 ? direction::to_pc : direction::to_mote, octets(50), start);
    bytes received;
    for (const auto& x : cable.on_time(start + 10s))
      received.insert(received.end(), x.octets.view().begin(), x.octets.view().end());
    return received;
  };
  CHECK(run(3) == run(3));
  CHECK(run(3) != run(4));
}

TEST_CASE("an empty chunk is not carried", "[serial][GW-01]") {
  auto cable = make_line();
  cable.send(direction::to_pc, payload(), start);
  CHECK_FALSE(cable.deadline());
}
