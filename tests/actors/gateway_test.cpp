#include "actors/frames.hpp"
#include "actors/kitchen.hpp"
#include "actors/sample_class.hpp"
#include "actors/services/gateway.hpp"
#include "core/tuples/device_keys.hpp"
#include "network/island_packet.hpp"
#include "support/catch.hpp"
#include "support/segments.hpp"
#include "testkit/fake.hpp"
#include "transport/segment.hpp"

using namespace rubicon;
using test::fake;
using test::fixture;
using test::kitchen;
using test::the_sink;

namespace {

constexpr mote_id fan{7};
constexpr auto adapter_latency = serial::line_config{}.latency;

struct gateway_fixture {
  fixture world;
  fake<peis_peer_actor> peer{world};
  fake<serial_line_actor> line{world};
  fake<ecology_actor> ecology{world};
  gateway_actor gateway;
  serial::direction end_taken{};
  serial::am_packet asked; ///< the first that it sends down

  gateway_fixture() {
    gateway_arguments x;
    x.config.island = kitchen;
    x.peer = peer.handle();
    x.line = line.handle();
    x.ecology = ecology.handle();
    gateway = world.spawn_at("gateway/kitchen", gateway_behavior, std::move(x));
    world.run_for(adapter_latency);
    end_taken = line.all<attach_serial>().at(0).towards;
    asked = packet_down();
    ack_frame();
    line.forget();
  }

  /// Until what it writes because of that has passed its adapter.
  template <class Message>
  void send(Message x) {
    world.send(gateway, std::move(x));
    world.run_for(adapter_latency);
  }

  /// The sink has written a packet.
  void from_sink(std::uint8_t am_type, bytes octets) {
    serial::am_packet x;
    x.source = the_sink.value;
    x.am_type = am_type;
    x.payload = std::move(octets);
    send(test::serial_frame(x, serial::frame_type::packet));
  }

  void join_fan() {
    from_sink(network::am::sink_event,
              encode(network::sink_event(network::mote_joined{fan, 3, 301, bytes{0xaa}})));
  }

  /// Newest value of an own tuple, in hexadecimal unless it is text.
  std::string tuple(std::string_view key) const {
    std::string value = "nothing";
    for (const auto& x : peer.all<set_tuple>()) {
      if (x.key == key)
        value = x.text ? to_string(x.value.view()) : to_hex(x.value.view());
    }
    return value;
  }

  /// The only active message on the line since it was last forgotten.
  serial::am_packet packet_down() const {
    const auto packets = test::packets_in(line.all<serial_write>());
    REQUIRE(packets.size() == 1);
    return packets[0];
  }

  void ack_frame() {
    const auto frames = test::frames_in(line.all<serial_write>());
    REQUIRE(!frames.empty());
    send(serial_octets{
        serial::encode(serial::frame{serial::frame_type::ack, frames.back().sequence, {}})});
  }

  std::uint64_t lost(const std::string& cause) {
    ecology.forget();
    send(status_request{});
    return ecology.all<serial_status>().at(0).serial.lost.at(cause);
  }
};

const bytes message_for_fan = encode(
    network::gateway_packet{fan, 10, encode(test::reliable(mote_id{9}, 1, 10, bytes{0x64}))});

} // namespace

TEST_CASE("a gateway takes its end of the line, its ports and its inputs, and has no devices",
          "[actors][gateway][GW-03][GW-13][ACT-01]") {
  gateway_fixture x;
  CHECK(x.end_taken == serial::direction::to_pc);
  CHECK(x.peer.all<hook_port>().at(0).port == 20);
  CHECK(x.peer.all<hook_port>().at(1).port == 21);
  for (const auto* key : {"devices.*.input.*", "devices.*.output.*.period"})
    CHECK(test::watch_on(x.peer, key).owner == gateway_of(kitchen));
  CHECK(x.tuple("devices") == "{}");
}

TEST_CASE("a mote that has joined becomes tuples and goes to the list",
          "[actors][gateway][GW-03][GW-04]") {
  gateway_fixture x;
  x.join_fan();
  CHECK(x.tuple("devices") == "{7}");
  CHECK(x.tuple("devices.7.type") == "0000012d");
  CHECK(x.tuple("devices.7.descriptor") == "aa");
  const auto changes = x.ecology.all<listing_changed>();
  REQUIRE(changes.size() == 1);
  CHECK(changes[0].mote == mote_address{kitchen, fan});
  CHECK(changes[0].listed);
  CHECK(changes[0].incarnation == 3);

  x.from_sink(network::am::sink_event,
              encode(network::sink_event(network::mote_left{fan, network::leave_cause::silence})));
  CHECK(x.tuple("devices") == "{}");
  CHECK(x.peer.all<delete_tuple>().at(0).key == "devices.7.type");
  const auto left = x.ecology.all<listing_changed>().back();
  CHECK(!left.listed);
  CHECK(left.cause == network::leave_cause::silence);
}

TEST_CASE("a mote's message becomes an output tuple", "[actors][gateway][GW-09]") {
  gateway_fixture x;
  x.join_fan();
  const auto segment = test::plain(fan, 2, bytes{0x01});
  x.from_sink(network::am::to_gateway,
              encode(network::island_packet{own_island, no_mote, 2, encode(segment)}));
  CHECK(x.tuple("devices.7.output.2") == "01");
}

TEST_CASE("an input tuple goes down the line and its status tells how it ended",
          "[actors][gateway][GW-12][IF-07]") {
  gateway_fixture x;
  x.join_fan();
  x.line.forget();
  x.send(tuple_event{1, gateway_of(kitchen), "devices.7.input.2", bytes{0x01}, false});
  CHECK(x.tuple("devices.7.input.2.status") == "1 pending");
  const auto down = x.packet_down();
  CHECK(down.destination == fan.value);
  CHECK(down.group == kitchen.value);
  CHECK(down.am_type == network::am::from_gateway);
  const auto packet = network::decode_island_packet(down.payload);
  REQUIRE(packet);
  CHECK(packet->mote == fan);
  CHECK(packet->channel == 2);
  const auto segment = transport::decode_segment(packet->body);
  REQUIRE(segment);
  CHECK(segment->source == no_mote);
  CHECK(segment->what == transport::segment::kind::hello);

  const auto accept = [&x](const transport::segment& sent) {
    x.ack_frame();
    x.line.forget();
    x.from_sink(network::am::to_gateway,
                encode(network::island_packet{kitchen, no_mote, 2,
                                              encode(test::acknowledgement(fan, sent))}));
  };
  accept(*segment);
  const auto command =
      transport::decode_segment(network::decode_island_packet(x.packet_down().payload)->body);
  REQUIRE(command);
  CHECK(command->what == transport::segment::kind::reliable);
  CHECK(command->payload == bytes{0x01});
  accept(*command);
  CHECK(x.tuple("devices.7.input.2.status") == "1 acknowledged");
}

TEST_CASE("an input for a mote that is not listed, a deleted one and a foreign key send nothing",
          "[actors][gateway][GW-12]") {
  gateway_fixture x;
  x.line.forget();
  const auto owner = gateway_of(kitchen);
  x.send(tuple_event{1, owner, "devices.7.input.2", bytes{0x01}, false});
  CHECK(x.tuple("devices.7.input.2.status") == "1 unreachable");
  x.join_fan();
  x.send(tuple_event{1, owner, "devices.7.input.2", bytes{0x01}, true});
  x.send(tuple_event{1, owner, "devices.7.input.2.status", bytes{0x01}, false});
  x.send(tuple_event{1, owner, "devices.x.input.2", bytes{0x01}, false});
  CHECK(x.line.count<serial_write>() == 0);
}

TEST_CASE("a gateway asks its sink who is there, which may have run for long",
          "[actors][gateway][GW-15]") {
  gateway_fixture x;
  CHECK(x.asked.am_type == network::am::sink_event);
  const auto event = network::decode_sink_event(x.asked.payload);
  REQUIRE(event);
  CHECK(std::get<network::describe>(*event).mote == broadcast_mote);
}

TEST_CASE("a message of another island goes down with its source island",
          "[actors][gateway][WIR-02][MCK-11]") {
  gateway_fixture x;
  x.join_fan();
  x.line.forget();
  x.send(peis_message{peer_id{2}, communication::island_message_port, message_for_fan});
  const auto packet = network::decode_island_packet(x.packet_down().payload);
  REQUIRE(packet);
  CHECK(packet->island == island_id{2});
  CHECK(packet->mote == fan);
  CHECK(packet->channel == 10);
}

TEST_CASE("a message for another island goes to its gateway", "[actors][gateway][WIR-02]") {
  gateway_fixture x;
  const auto segment = test::reliable(fan, 1, 10, bytes{0x64});
  x.from_sink(network::am::to_gateway,
              encode(network::island_packet{island_id{2}, mote_id{9}, 10, encode(segment)}));
  const auto sent = x.peer.all<send_peis_message>();
  REQUIRE(sent.size() == 1);
  CHECK(sent[0].destination == peer_id{2});
  CHECK(sent[0].port == communication::island_message_port);
  CHECK(sent[0].reliable);
  CHECK(sent[0].octets ==
        payload(encode(network::gateway_packet{mote_id{9}, 10, encode(segment)})));
}

TEST_CASE("gateways use messages among themselves and broadcasts to find each other, nothing else",
          "[actors][gateway][API-11][GW-13]") {
  gateway_fixture x;
  x.join_fan();
  x.send(peis_message{peer_id{2}, communication::island_message_port, payload(message_for_fan)});
  x.from_sink(network::am::to_gateway,
              encode(network::island_packet{island_id{2}, mote_id{9}, 10,
                                            encode(test::reliable(fan, 1, 10, bytes{0x64}))}));
  x.world.run_for(1min);
  const auto sent = x.peer.all<send_peis_message>();
  const auto broadcasts = x.peer.all<broadcast_peis_message>();
  CHECK(sent.size() == 1);
  CHECK(!broadcasts.empty());
  for (const auto& each : sent)
    CHECK(each.port == communication::island_message_port);
  for (const auto& each : broadcasts)
    CHECK(each.port == gateway::announcement_port);
  // All else is about its own tuples.
  CHECK(x.peer.size() == sent.size() + broadcasts.size() + x.peer.count<hook_port>() +
                             x.peer.count<watch_tuples>() + x.peer.count<watch_subscribers>() +
                             x.peer.count<watch_clock>() + x.peer.count<set_tuple>() +
                             x.peer.count<delete_tuple>());
  for (const auto& each : x.peer.all<watch_tuples>())
    CHECK(each.owner == peer_id{static_cast<std::int32_t>(kitchen.value)});
}

TEST_CASE("a gateway reports a packet lost when nobody acks", "[actors][gateway][GW-16]") {
  gateway_fixture x;
  x.join_fan();
  x.line.forget();
  x.send(peis_message{peer_id{2}, communication::island_message_port, message_for_fan});
  x.world.run_for(300ms);
  CHECK(x.line.count<serial_write>() >= 3); // waits know how long a frame takes
  CHECK(x.lost("gateway_no_ack") == 0);
  x.world.run_for(300ms); // four attempts
  CHECK(x.lost("gateway_no_ack") == 1);
  CHECK(x.world.logged("event=lost packet=2") == 1);
  x.world.run_for(1min);
  CHECK(x.line.count<serial_write>() == 4);
}

TEST_CASE("a packet that is acked is written once", "[actors][gateway][GW-16]") {
  gateway_fixture x;
  x.join_fan();
  x.line.forget();
  x.send(peis_message{peer_id{2}, communication::island_message_port, message_for_fan});
  x.ack_frame();
  x.world.run_for(1min);
  CHECK(x.line.count<serial_write>() == 1);
  CHECK(x.lost("gateway_no_ack") == 0);
}

TEST_CASE("a gateway counts what is no frame and no packet, and goes on", "[actors][gateway]") {
  gateway_fixture x;
  auto octets = serial::encode(serial::frame{serial::frame_type::packet, 0, bytes{0, 1, 2}});
  x.send(serial_octets{octets});
  octets[3] ^= 1;
  x.send(serial_octets{octets});
  x.from_sink(network::am::sink_event, bytes{0xee});
  x.send(peis_message{peer_id{2}, communication::island_message_port, bytes{1}});
  CHECK(x.lost("gateway_malformed") == 1);
  CHECK(x.lost("gateway_crc") == 1);
  x.join_fan();
  CHECK(x.tuple("devices") == "{7}");
  x.send(status_request{});
  CHECK(x.ecology.all<devices_status>().back().listed == std::vector{fan});
  CHECK(x.ecology.all<message_status>().back().who.island == kitchen);
}
