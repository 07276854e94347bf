#include "actors/kitchen.hpp"
#include "actors/serial/serial_line.hpp"
#include "support/catch.hpp"
#include "testkit/fake.hpp"

using namespace rubicon;
using serial::direction;
using test::fake;
using test::fixture;
using test::kitchen;

namespace {

struct serial_line_fixture {
  fixture world;
  fake<ecology_actor> ecology{world};
  fake<serial_end_actor> pc{world};
  fake<serial_end_actor> mote{world};
  serial::line_config config;
  serial_line_actor line;

  explicit serial_line_fixture(double octet_error = 0) {
    config.octet_error = octet_error;
    line =
        world.spawn_at("serial_line/kitchen", serial_line, serial::line(config, random_stream(3)),
                       config.latency, kitchen, ecology.handle());
    world.send(line, attach_serial{direction::to_pc, pc});
    world.send(line, attach_serial{direction::to_mote, mote});
  }

  void write(direction towards, std::size_t octets) {
    world.send(line, serial_write{towards, bytes(octets, 0x55)});
  }

  report::serial_report report() {
    ecology.forget();
    world.send(line, status_request{});
    return ecology.all<serial_status>().at(0).serial;
  }
};

} // namespace

TEST_CASE("octets arrive at the PC ten bit times an octet and the adapter's latency after they are "
          "written",
          "[actors][serial][GEN-03][ACT-01]") {
  serial_line_fixture x;
  x.write(direction::to_pc, 48);
  const auto due = serial::transmission_time(48, 57600) + 1ms;
  CHECK(due / 1us == 9333);
  x.world.run_for(due - 1ns);
  CHECK(x.pc.size() == 0);
  x.world.run_for(1ns);
  REQUIRE(x.pc.count<serial_octets>() == 1);
  CHECK(x.pc.all<serial_octets>()[0].octets == payload(bytes(48, 0x55)));
  CHECK(x.mote.size() == 0);
}

TEST_CASE("the two directions do not wait for each other, writes in one direction do",
          "[actors][serial][GEN-03]") {
  serial_line_fixture x;
  x.write(direction::to_pc, 100);
  x.write(direction::to_pc, 10);
  x.write(direction::to_mote, 10);
  x.world.run_for(1s);
  const auto time = [](std::size_t octets) {
    return instant(serial::transmission_time(octets, 57600) + 1ms);
  };
  CHECK(x.mote.times<serial_octets>() == std::vector{time(10) - 1ms});
  REQUIRE(x.pc.count<serial_octets>() == 2);
  CHECK(x.pc.times<serial_octets>()[0] == time(100));
  CHECK(x.pc.times<serial_octets>()[1] - time(110) <= 1ns); // two roundings instead of one
}

TEST_CASE("an unplugged line loses and counts what is written and in flight, and works again "
          "once it is plugged in",
          "[actors][serial][ACT-04]") {
  serial_line_fixture x;
  x.write(direction::to_mote, 20);
  x.world.send(x.line, plug_serial{false});
  x.write(direction::to_pc, 30);
  x.world.run_for(1s);
  CHECK(x.pc.size() == 0);
  CHECK(x.mote.size() == 0);
  const auto events = x.ecology.all<notable_event>();
  REQUIRE(events.size() == 1);
  CHECK(events[0].who == "serial_line/kitchen");
  CHECK(events[0].what == "serial cable unplugged");
  CHECK(x.report().lost.at("unplugged_octets") == 50);

  x.world.send(x.line, plug_serial{true});
  CHECK(x.ecology.all<notable_event>().at(0).what == "serial cable plugged in again");
  x.write(direction::to_pc, 7);
  x.write(direction::to_mote, 8);
  x.world.run_for(1s);
  CHECK(x.pc.count<serial_octets>() == 1);
  CHECK(x.mote.count<serial_octets>() == 1);
  const auto report = x.report();
  CHECK(report.octets == 15);
  CHECK(report.lost.at("unplugged_octets") == 50);
}

TEST_CASE("a line's report names its island and counts corrupted and overflowed octets",
          "[actors][serial]") {
  serial_line_fixture x(1.0);
  x.write(direction::to_pc, 5000);
  x.world.run_for(2s);
  const auto report = x.report();
  CHECK(x.ecology.all<serial_status>().at(0).island == kitchen);
  CHECK(report.lost.at("line_overflow_octets") == 5000 - x.config.buffer);
  CHECK(report.octets == x.config.buffer);
  CHECK(report.lost.at("corrupted_octets") == x.config.buffer);
}

TEST_CASE("octets for an end to which nobody is attached go nowhere", "[actors][serial]") {
  fixture world;
  fake<ecology_actor> ecology(world);
  const auto line =
      world.spawn(serial_line, serial::line({}, random_stream(3)), 1ms, kitchen, ecology.handle());
  world.send(line, serial_write{direction::to_pc, bytes{1}});
  world.run_for(1s);
  CHECK(world.ends().empty());
}

TEST_CASE("octets that come to an end whose mote is off are gone, and counted",
          "[actors][serial][ACT-04]") {
  serial_line_fixture x;
  CHECK_FALSE(x.report().lost.contains("end_off_octets"));
  x.world.send(x.line, attach_serial{direction::to_mote, {}});
  x.write(direction::to_mote, 30);
  x.write(direction::to_pc, 10);
  x.world.run_for(1s);
  CHECK(x.mote.size() == 0);
  CHECK(x.pc.count<serial_octets>() == 1);
  CHECK(x.report().lost.at("end_off_octets") == 30);
  x.world.send(x.line, attach_serial{direction::to_mote, x.mote});
  x.write(direction::to_mote, 5);
  x.world.run_for(1s);
  CHECK(x.mote.count<serial_octets>() == 1);
  CHECK(x.report().lost.at("end_off_octets") == 30);
}
