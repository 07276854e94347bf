#include "actors/frames.hpp"
#include "actors/sink.hpp"
#include "mote/descriptor.hpp"
#include "network/island_packet.hpp"
#include "support/catch.hpp"
#include "support/fakes.hpp"

using namespace rubicon;
using test::fake;
using test::virtual_world;

namespace {

constexpr mote_address sink_address{island_id{5}, mote_id{1}};
constexpr mote_id stove{7};
constexpr radio::radio_index sink_radio{3};

struct rig {
  virtual_world world;
  fake<air_actor> air{world};
  fake<serial_line_actor> line{world};
  fake<ecology_actor> ecology{world};
  sink_actor sink;

  rig() {
    mote::registrar_config registrar;
    registrar.island = sink_address.island;
    sink = world.spawn_at("sink/kitchen", rubicon::sink,
                          sink_arguments{sink_address,
                                         registrar,
                                         {},
                                         sink_radio,
                                         air.handle(),
                                         line.handle(),
                                         {},
                                         1,
                                         ecology.handle()});
  }

  void hear(const mote::management& x) {
    world.send(sink, test::radio_frame(stove, sink_address.mote, x));
  }

  void join() {
    const auto descriptor = mote::encode(mote::descriptor{101, 1, 0, 3000});
    hear(mote::join_request{77, 2, descriptor});
    hear(mote::join_confirm{77, 2, descriptor});
    world.run_for(50ms);
  }

  std::vector<network::sink_event> events() const {
    std::vector<network::sink_event> found;
    for (const auto& x : test::packets_in(line.all<serial_write>())) {
      if (auto event = network::decode_sink_event(x.payload))
        found.push_back(*std::move(event));
    }
    return found;
  }
};

serial::am_packet packet_down() {
  serial::am_packet x;
  x.destination = stove.value;
  x.am_type = network::am::from_gateway;
  x.payload = encode(network::island_packet{sink_address.island, stove, 2, bytes{9, 8}});
  return x;
}

} // namespace

TEST_CASE("a sink takes its radio and its end of the line", "[actors][sink][GW-01]") {
  rig x;
  REQUIRE(x.air.count<attach_radio>() == 1);
  CHECK(x.air.all<attach_radio>()[0].radio == sink_radio);
  REQUIRE(x.line.count<attach_serial>() == 1);
  CHECK(x.line.all<attach_serial>()[0].towards == serial::direction::to_mote);
}

TEST_CASE("a join on the radio ends in a mote_joined event on the line",
          "[actors][sink][DIS-08][MCK-15]") {
  rig x;
  const auto descriptor = mote::encode(mote::descriptor{101, 1, 0, 3000});
  x.hear(mote::join_request{77, 2, descriptor});
  REQUIRE(x.air.count<radio_send>() == 1);
  const auto sent = x.air.all<radio_send>()[0];
  CHECK(sent.radio == sink_radio);
  CHECK(sent.destination == stove);
  CHECK(sent.ack);
  const auto reply = test::management_in<mote::join_reply>(sent);
  REQUIRE(reply);
  CHECK(reply->sequence == 77);
  CHECK(reply->island == sink_address.island);
  CHECK(reply->mote == stove);
  x.world.run_for(50ms);
  CHECK(x.events().empty()); // it has not confirmed yet

  x.hear(mote::join_confirm{77, 2, descriptor});
  x.world.run_for(50ms);
  const auto packets = test::packets_in(x.line.all<serial_write>());
  REQUIRE(packets.size() == 1);
  CHECK(packets[0].source == sink_address.mote.value);
  CHECK(packets[0].group == sink_address.island.value);
  CHECK(packets[0].am_type == network::am::sink_event);
  REQUIRE(x.events().size() == 1);
  CHECK(x.events()[0] == network::sink_event(network::mote_joined{stove, 2, 101, descriptor}));
  CHECK(x.line.all<serial_write>()[0].towards == serial::direction::to_pc);
}

TEST_CASE("a mote that falls silent leaves the island", "[actors][sink][DIS-06]") {
  rig x;
  x.join();
  x.world.run_for(11s);
  bool left = false;
  for (const auto& event : x.events())
    left = left ||
           event == network::sink_event(network::mote_left{stove, network::leave_cause::silence});
  CHECK(left);
}

TEST_CASE("a sink carries island packets both ways and acks what the PC sends",
          "[actors][sink][RTG-02][GW-16]") {
  rig x;
  x.join();
  x.air.forget();
  x.line.forget();
  x.world.send(x.sink, test::serial_frame(packet_down(), serial::frame_type::packet_with_ack, 42));
  x.world.run_for(50ms);
  REQUIRE(x.air.count<radio_send>() == 1);
  const auto sent = x.air.all<radio_send>()[0];
  CHECK(sent.destination == stove);
  CHECK(sent.am_type == network::am::from_gateway);
  CHECK(to_bytes(sent.octets.view()) == packet_down().payload);
  const auto frames = test::frames_in(x.line.all<serial_write>());
  REQUIRE(frames.size() == 1);
  CHECK(frames[0].type == serial::frame_type::ack);
  CHECK(frames[0].sequence == 42);

  x.line.forget();
  const auto up = encode(network::island_packet{sink_address.island, no_mote, 1, bytes{1, 2}});
  x.world.send(x.sink, test::radio_frame(stove, sink_address.mote, network::am::to_gateway, up));
  x.world.run_for(50ms);
  const auto packets = test::packets_in(x.line.all<serial_write>());
  REQUIRE(packets.size() == 1);
  CHECK(packets[0].source == stove.value);
  CHECK(packets[0].am_type == network::am::to_gateway);
  CHECK(packets[0].payload == up);
}

TEST_CASE("octets with a bad CRC do nothing but count", "[actors][sink][GW-16]") {
  rig x;
  auto octets = to_bytes(
      test::serial_frame(packet_down(), serial::frame_type::packet_with_ack, 42).octets.view());
  octets[octets.size() - 4] ^= 1; // in the payload
  x.air.forget();
  x.world.send(x.sink, serial_octets{octets});
  x.world.run_for(1s);
  CHECK(x.air.size() == 0);
  CHECK(x.line.count<serial_write>() == 0);
  x.world.send(x.sink, status_request{});
  REQUIRE(x.ecology.count<serial_status>() == 1);
  const auto status = x.ecology.all<serial_status>()[0];
  CHECK(status.island == sink_address.island);
  CHECK(status.serial.lost.at("sink_crc") == 1);
  CHECK(status.serial.frames_received == 0);
}

TEST_CASE("a radio frame that is no frame does nothing", "[actors][sink]") {
  rig x;
  auto frame = test::radio_frame(stove, sink_address.mote, mote::leave_notice{});
  auto octets = to_bytes(frame.psdu.view());
  octets[12] ^= 1;
  x.air.forget();
  x.world.send(x.sink, frame_received{octets, -60});
  x.world.send(x.sink, frame_received{bytes{}, -60});
  x.world.run_for(1s);
  CHECK(x.air.size() == 0);
  CHECK(x.world.ends().empty());
}
