// TinyOS's BaseStation in a sink's place, and a mote with plain programs.
#include "actors/frames.hpp"
#include "actors/island/base_station.hpp"
#include "actors/island/mote.hpp"
#include "serial/raw_packet.hpp"
#include "support/catch.hpp"
#include "testkit/fake.hpp"

using namespace rubicon;
using test::fake;
using test::fixture;

namespace {

constexpr mote_address base_address{island_id{5}, mote_id{1}};
constexpr radio::radio_index radio_of_it{3};

struct base_fixture {
  fixture world;
  fake<air_actor> air{world};
  fake<serial_line_actor> line{world};
  fake<ecology_actor> ecology{world};
  sink_actor base;

  base_fixture() {
    sink_arguments x;
    x.address = base_address;
    x.is_base_station = true;
    x.radio = radio_of_it;
    x.air = air.handle();
    x.lines = {{line.handle(), {.payload_max = serial::base_station_payload}}};
    x.ecology = ecology.handle();
    base = world.spawn_at("sink/kitchen", rubicon::base_station, std::move(x), mote::nonvolatile{});
  }

  void down(std::uint16_t to, bytes content, std::uint8_t sequence) {
    serial::am_packet x;
    x.destination = to;
    x.am_type = 6;
    x.payload = std::move(content);
    world.send(base, test::serial_frame(x, serial::frame_type::packet_with_ack, sequence));
    world.run_for(2ms); // its receive buffers are free again
  }

  void done(radio::send_status how) {
    const auto request = air.all<radio_send>().back();
    world.send(base, radio_done{request.token, how, 1, true, {}});
  }
};

} // namespace

TEST_CASE("a base station takes its radio and its end of the line", "[actors][tinyos][GW-17]") {
  base_fixture x;
  REQUIRE(x.air.count<attach_radio>() == 1);
  CHECK(x.air.all<attach_radio>()[0].radio == radio_of_it);
  REQUIRE(x.line.count<attach_serial>() == 1);
  CHECK(x.line.all<attach_serial>()[0].towards == serial::direction::to_mote);
  REQUIRE(x.ecology.count<store_written>() == 1);
  CHECK(x.ecology.all<store_written>()[0].content.starts == 1);
  x.world.run_for(1h);
  CHECK(x.air.count<radio_send>() == 0); // it has nothing to say
  CHECK(x.line.count<serial_write>() == 0);
}

TEST_CASE("a base station writes what its radio hears, for whomever", "[actors][tinyos][GW-17]") {
  base_fixture x;
  x.world.send(x.base, test::radio_frame(mote_id{7}, mote_id{9}, 6, {0, 7, 0, 1}, 0x22));
  x.world.send(x.base, frame_received{payload(bytes{1, 2, 3}), -60}); // of another layout
  x.world.run_for(1s);
  const auto frames = test::frames_in(x.line.all<serial_write>());
  REQUIRE(frames.size() == 2);
  CHECK(frames[0].type == serial::frame_type::packet); // it asks for no ack
  CHECK(frames[0].packet == bytes{0, 0, 9, 0, 7, 4, 0x22, 6, 0, 7, 0, 1});
  CHECK(frames[1].type == serial::frame_type::packet);
  CHECK(frames[1].packet == serial::wrap_raw(bytes{1})); // without its FCS
}

TEST_CASE("a base station sends what comes over the line, one after the other",
          "[actors][tinyos][GW-17]") {
  base_fixture x;
  x.down(7, {1}, 1);
  x.down(0xffff, {2}, 2);
  REQUIRE(x.air.count<radio_send>() == 1);
  const auto first = x.air.all<radio_send>()[0];
  CHECK(first.destination == mote_id{7});
  CHECK(!first.ack);
  CHECK(first.am_type == 6);
  x.done(radio::send_status::channel_access_failure);
  REQUIRE(x.air.count<radio_send>() == 2);
  CHECK(to_bytes(x.air.all<radio_send>()[1].octets.view()) == bytes{1}); // again
  x.done(radio::send_status::sent);
  REQUIRE(x.air.count<radio_send>() == 3);
  CHECK(to_bytes(x.air.all<radio_send>()[2].octets.view()) == bytes{2});
  x.done(radio::send_status::sent);
  CHECK(x.air.count<radio_send>() == 3);
  std::size_t acks = 0;
  for (const auto& each : test::frames_in(x.line.all<serial_write>()))
    acks += each.type == serial::frame_type::ack ? 1 : 0;
  CHECK(acks == 2);
}

TEST_CASE("what a base station has counted is reported, also of a life that fails",
          "[actors][tinyos][ACT-03]") {
  base_fixture x;
  x.world.send(x.base, test::radio_frame(mote_id{7}, broadcast_mote, 6, {0, 1}));
  x.world.send(x.base, test::radio_frame(mote_id{7}, broadcast_mote, 6, bytes(29)));
  const auto counted = [&x] { return x.ecology.all<module_status>().back().counters; };
  x.world.send(x.base, status_request{});
  CHECK(counted().at("base_station.up") == 1);
  CHECK(counted().at("base_station.up_too_long") == 1);
  x.world.send(x.base, crash_now{});
  REQUIRE(x.world.ends().size() == 1);
  CHECK(x.ecology.count<module_status>() == 2);
}

TEST_CASE("a mote runs plain programs without any stack", "[actors][mote][tinyos][GW-17]") {
  fixture world;
  fake<air_actor> air{world};
  fake<ecology_actor> ecology{world};
  mote_arguments x;
  x.address = {island_id{5}, mote_id{7}};
  x.name = "kitchen/scope";
  x.stack = config::stack::plain;
  x.node.transducers = {{device::quantity::light, device::constant_model{30}, 0, 0.1}};
  x.apps = {tinyos::program_config{.kind = tinyos::program_kind::oscilloscope,
                                   .every = 100ms,
                                   .transducer = device::quantity::light},
            tinyos::program_config{.kind = tinyos::program_kind::blink, .every = 250ms}};
  x.path = {{0s, {0, 0, 0}}, {100s, {100, 0, 0}}};
  x.stays_when_flat = true;
  x.air = air.handle();
  x.ecology = ecology.handle();
  const auto mote = world.spawn_at("mote/kitchen/scope", mote_behavior,
                                   std::make_shared<const mote_arguments>(x), mote::nonvolatile{});
  const auto answer = [&] { // as the air: each request ends
    static_cast<void>(world);
    const auto all = air.all<radio_send>();
    for (const auto& each : all)
      world.send(mote, radio_done{each.token, radio::send_status::sent, 1, true, {}});
  };
  for (int i = 0; i < 20; ++i) {
    world.run_for(100ms);
    answer();
  }
  std::size_t readings = 0;
  std::size_t counts = 0;
  for (const auto& each : air.all<radio_send>()) {
    CHECK(each.destination == broadcast_mote);
    CHECK(!each.ack);
    const auto octets = to_bytes(each.octets.view());
    if (each.am_type == 0x93) {
      ++readings;
      CHECK(octets.size() == 28);
      CHECK(octets.at(9) == 300 % 256); // in counts
    } else {
      ++counts;
      CHECK(octets.at(1) == 7);
    }
  }
  CHECK(readings == 1);
  CHECK(counts >= 7);
  CHECK(counts <= 8);
  // A flat battery: no packets, and no steps.
  world.send(mote, battery_flat{});
  CHECK(ecology.count<mote_flat>() == 1);
  air.forget();
  world.run_for(30s);
  CHECK(air.count<radio_send>() == 0);
  CHECK(air.count<move_radio>() == 0);
  world.send(mote, status_request{});
  CHECK(ecology.all<module_status>().back().counters.at("blink.packets") == counts);
}

TEST_CASE("a mote with a flat battery is carried on unless it is to stay", "[actors][mote]") {
  fixture world;
  fake<air_actor> air{world};
  fake<ecology_actor> ecology{world};
  mote_arguments x;
  x.address = {island_id{5}, mote_id{7}};
  x.name = "kitchen/scope";
  x.stack = config::stack::plain;
  x.path = {{0s, {0, 0, 0}}, {100s, {100, 0, 0}}};
  x.air = air.handle();
  x.ecology = ecology.handle();
  const auto mote = world.spawn_at("mote/kitchen/scope", mote_behavior,
                                   std::make_shared<const mote_arguments>(x), mote::nonvolatile{});
  world.run_for(5s);
  world.send(mote, battery_flat{});
  air.forget();
  world.run_for(5s);
  CHECK(air.count<move_radio>() == 5);
}
