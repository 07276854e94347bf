#include "actors/frames.hpp"
#include "actors/island/sink.hpp"
#include "actors/island_partner.hpp"
#include "actors/kitchen.hpp"
#include "mote/join/descriptor.hpp"
#include "network/island_packet.hpp"
#include "support/catch.hpp"
#include "support/segments.hpp"
#include "testkit/fake.hpp"

using namespace rubicon;
using test::fake;
using test::fixture;
using test::stove;

namespace {

constexpr mote_address sink_address{island_id{5}, mote_id{1}};
constexpr radio::radio_index sink_radio{3};

struct sink_fixture {
  fixture world;
  fake<air_actor> air{world};
  fake<serial_line_actor> line{world};
  fake<ecology_actor> ecology{world};
  sink_actor sink;
  test::island_partner<sink_actor> island{
      world, air, sink, sink_address.mote, {.width = 2, .island = sink_address.island}};

  sink_fixture() {
    mote::registrar_config registrar;
    registrar.island = sink_address.island;
    sink_arguments x;
    x.address = sink_address;
    x.registrar = registrar;
    x.radio = sink_radio;
    x.air = air.handle();
    x.lines = {{line.handle(), {}}};
    x.seed = 1;
    x.ecology = ecology.handle();
    sink = world.spawn_at("sink/kitchen", rubicon::sink, std::move(x), mote::nonvolatile{});
  }

  void join() {
    REQUIRE(island.run_until([this] { return !events().empty(); }, 1min));
    island.run_for(1s);
    island.sent.clear();
    line.forget();
  }

  /// But for questions about the time.
  std::vector<network::sink_event> events() const {
    std::vector<network::sink_event> found;
    for (const auto& x : test::packets_in(line.all<serial_write>())) {
      auto event = network::decode_sink_event(x.payload);
      if (event && !std::holds_alternative<network::time_request>(*event))
        found.push_back(*std::move(event));
    }
    return found;
  }
};

serial::am_packet packet_down() {
  serial::am_packet x;
  x.destination = stove.mote.value;
  x.am_type = network::am::from_gateway;
  x.payload = encode(network::island_packet{island_id{2}, stove.mote, 2,
                                            encode(test::plain(mote_id{9}, 2, bytes{9, 8}))});
  return x;
}

} // namespace

TEST_CASE("a sink takes its radio and its end of the line", "[actors][sink][GW-01][ACT-01]") {
  sink_fixture x;
  REQUIRE(x.air.count<attach_radio>() == 1);
  CHECK(x.air.all<attach_radio>()[0].radio == sink_radio);
  REQUIRE(x.line.count<attach_serial>() == 1);
  CHECK(x.line.all<attach_serial>()[0].towards == serial::direction::to_mote);
}

TEST_CASE("a join on the radio ends in a mote_joined event on the line",
          "[actors][sink][DIS-08][MCK-15]") {
  sink_fixture x;
  REQUIRE(x.island.run_until([&x] { return x.island.cores.joined() == 1; }, 1min));
  REQUIRE(!x.island.sent.empty());
  const auto& reply = x.island.sent[0];
  CHECK(reply.radio == sink_radio);
  CHECK(reply.destination == stove.mote);
  CHECK(reply.am_type == network::am::down);
  CHECK(reply.ack);
  REQUIRE(x.island.cores.memberships.size() == 1);
  CHECK(x.island.cores.memberships[0].second.island == sink_address.island);

  x.island.run_for(1s); // and it confirms
  const auto packets = test::packets_in(x.line.all<serial_write>());
  REQUIRE(!packets.empty());
  CHECK(packets[0].source == sink_address.mote.value);
  CHECK(packets[0].group == sink_address.island.value);
  CHECK(packets[0].am_type == network::am::sink_event);
  REQUIRE(x.events().size() == 2);
  CHECK(std::holds_alternative<network::sink_started>(x.events()[0]));
  const auto joined = std::get<network::mote_joined>(x.events()[1]);
  CHECK(joined.mote == stove.mote);
  CHECK(joined.incarnation == 0);
  CHECK(joined.type == 301);
  CHECK(mote::decode_descriptor(joined.descriptor)->type == 301);
  CHECK(x.line.all<serial_write>()[0].towards == serial::direction::to_pc);
}

TEST_CASE("a mote that falls silent leaves the island", "[actors][sink][DIS-06]") {
  sink_fixture x;
  x.join();
  x.island.cores.kill(stove.mote);
  x.island.run_for(11s);
  bool left = false;
  for (const auto& event : x.events())
    left = left || event == network::sink_event(
                                network::mote_left{stove.mote, network::leave_cause::silence});
  CHECK(left);
}

TEST_CASE("a sink carries island packets both ways and acks what the PC sends",
          "[actors][sink][RTG-02][GW-16]") {
  sink_fixture x;
  x.join();
  x.world.send(x.sink, test::serial_frame(packet_down(), serial::frame_type::packet_with_ack, 42));
  x.island.run_for(200ms);
  REQUIRE(x.island.cores.received.size() == 1);
  CHECK(x.island.cores.received[0].first == stove.mote);
  CHECK(x.island.cores.received[0].second.source == mote_address{island_id{2}, mote_id{9}});
  CHECK(x.island.cores.received[0].second.payload == bytes{9, 8});
  const auto frames = test::frames_in(x.line.all<serial_write>());
  REQUIRE(frames.size() == 1);
  CHECK(frames[0].type == serial::frame_type::ack);
  CHECK(frames[0].sequence == 42);

  x.line.forget();
  REQUIRE(x.island.cores.send(stove.mote, {own_island, no_mote}, 1, bytes{1, 2}, false));
  x.island.run_for(200ms);
  const auto packets = test::packets_in(x.line.all<serial_write>());
  REQUIRE(packets.size() == 1);
  CHECK(packets[0].source == stove.mote.value);
  CHECK(packets[0].am_type == network::am::to_gateway);
  CHECK(packets[0].payload ==
        encode(network::island_packet{sink_address.island, no_mote, 1,
                                      encode(test::plain(stove.mote, 1, bytes{1, 2}))}));
}

TEST_CASE("octets with a bad CRC do nothing but count", "[actors][sink][GW-16]") {
  sink_fixture x;
  x.join();
  auto octets = to_bytes(
      test::serial_frame(packet_down(), serial::frame_type::packet_with_ack, 42).octets.view());
  octets[octets.size() - 4] ^= 1; // in the payload
  x.line.forget();
  x.world.send(x.sink, serial_octets{octets});
  CHECK(x.line.count<serial_write>() == 0);
  x.island.run_for(1s);
  CHECK(x.island.cores.received.empty());
  x.world.send(x.sink, status_request{});
  REQUIRE(x.ecology.count<serial_status>() == 1);
  const auto status = x.ecology.all<serial_status>()[0];
  CHECK(status.island == sink_address.island);
  CHECK(status.serial.lost.at("sink_crc") == 1);
  CHECK(status.serial.frames_received == 0);
}

TEST_CASE("a radio frame that is no frame does nothing", "[actors][sink]") {
  sink_fixture x;
  const auto lost = encode(network::up_packet{stove.mote, sink_address.mote, 1, 0, 0, bytes{1}});
  auto frame = test::radio_frame(stove.mote, sink_address.mote, network::am::up, lost);
  auto octets = to_bytes(frame.psdu.view());
  octets[12] ^= 1;
  x.air.forget();
  x.world.send(x.sink, frame_received{octets, -60});
  x.world.send(x.sink, frame_received{bytes{}, -60});
  x.world.run_for(1s);
  CHECK(std::ranges::all_of(x.air.all<radio_send>(),
                            [](const auto& sent) { return sent.am_type == network::am::beacon; }));
  CHECK(x.world.ends().empty());
}
