// A gateway whose sink, or whose user, is outside of the ecology.
#include <memory>
#include <vector>

#include "actors/frames.hpp"
#include "actors/kitchen.hpp"
#include "actors/serial/replay_line.hpp"
#include "actors/services/gateway.hpp"
#include "network/am.hpp"
#include "network/sink_event.hpp"
#include "support/catch.hpp"
#include "testkit/fake.hpp"

using namespace rubicon;
using test::fake;
using test::fixture;
using test::kitchen;

namespace {

serial::am_packet message(std::uint8_t am_type) {
  serial::am_packet x;
  x.source = 7;
  x.am_type = am_type;
  x.payload = bytes{1, 2, 3};
  return x;
}

struct exporting_fixture {
  fixture world;
  fake<peis_peer_actor> peer{world};
  fake<serial_line_actor> line{world};
  fake<forwarder_server_actor> forwarder{world};
  fake<ecology_actor> ecology{world};
  gateway_actor gateway;

  exporting_fixture() {
    gateway_arguments x;
    x.config.island = kitchen;
    x.peer = peer.handle();
    x.line = line.handle();
    x.line_is_real = true;
    x.forwarder = forwarder.handle();
    x.ecology = ecology.handle();
    gateway = world.spawn_at("gateway/kitchen", gateway_behavior, std::move(x));
    ack_all();
  }

  /// What a gateway asks of its sink of its own is answered.
  void ack_all() {
    for (const auto& x : test::frames_in(line.all<serial_write>()))
      world.send(gateway, serial_octets{serial::encode(
                              serial::frame{serial::frame_type::ack, x.sequence, {}})});
    line.forget();
  }
};

} // namespace

TEST_CASE("a gateway gives each packet of its sink to a forwarder, too",
          "[actors][gateway][GW-17]") {
  exporting_fixture x;
  CHECK(x.forwarder.count<attach_packets>() == 1);
  x.world.send(x.gateway, test::serial_frame(message(6), serial::frame_type::packet));
  const auto given = x.forwarder.all<serial_packet>();
  REQUIRE(given.size() == 1);
  CHECK(given[0].token == 0);
  CHECK(given[0].octets == payload(serial::encode(message(6))));
}

TEST_CASE("a gateway sends what a program sends, at once to a real line, and says when it is done",
          "[actors][gateway][GW-17]") {
  exporting_fixture x;
  x.world.send(x.gateway, serial_packet{3, payload(serial::encode(message(9)))});
  const auto packets = test::packets_in(x.line.all<serial_write>());
  REQUIRE(packets.size() == 1);
  CHECK(packets[0] == message(9));
  CHECK(x.forwarder.count<serial_packet_done>() == 0);
  x.ack_all();
  REQUIRE(x.forwarder.count<serial_packet_done>() == 1);
  CHECK(x.forwarder.all<serial_packet_done>()[0].token == 3);
}

TEST_CASE("of a program's packet that no sink takes a gateway says that it is done with",
          "[actors][gateway][GW-17]") {
  exporting_fixture x;
  x.world.send(x.gateway, serial_packet{4, payload(bytes(253, 2))}); // longer than a mote takes
  CHECK(x.forwarder.count<serial_packet_done>() == 1);
  x.world.send(x.gateway, serial_packet{5, payload(serial::encode(message(9)))});
  x.world.run_for(10s);
  CHECK(x.forwarder.count<serial_packet_done>() == 2);
}

TEST_CASE("a gateway tells once that its sink takes no long packets, until that is one of ours",
          "[actors][gateway][GW-16][GW-17]") {
  fixture world;
  fake<peis_peer_actor> peer{world};
  fake<serial_line_actor> line{world};
  fake<forwarder_server_actor> forwarder{world};
  fake<ecology_actor> ecology{world};
  for (const bool may_be_own : {false, true}) {
    gateway_arguments arguments;
    arguments.config.island = kitchen;
    arguments.peer = peer.handle();
    arguments.line = line.handle();
    arguments.line_is_real = true;
    arguments.may_be_own_sink = may_be_own;
    arguments.port.payload_max = 28;
    arguments.port.window = 2;
    arguments.forwarder = forwarder.handle();
    arguments.ecology = ecology.handle();
    const auto gateway = world.spawn_at(may_be_own ? "gateway/own" : "gateway/plain",
                                        gateway_behavior, std::move(arguments));
    const auto written = [&](std::size_t octets) {
      for (const auto& x : test::frames_in(line.all<serial_write>())) // all that waits is acked
        world.send(gateway, serial_octets{serial::encode(
                                serial::frame{serial::frame_type::ack, x.sequence, {}})});
      line.forget();
      auto x = message(9);
      x.payload = bytes(octets);
      world.send(gateway, serial_packet{4, payload(serial::encode(x))});
      return test::packets_in(line.all<serial_write>()).size();
    };
    ecology.forget();
    CHECK(written(29) == 0);
    CHECK(written(40) == 0);
    CHECK(ecology.count<notable_event>() == 1);
    CHECK(ecology.all<notable_event>().at(0).what.find("more than 28 octets") != std::string::npos);
    CHECK(written(28) == 1);
    serial::am_packet started;
    started.source = 1;
    started.am_type = network::am::sink_event;
    started.payload =
        network::encode(network::sink_event(network::mote_joined{mote_id{2}, 1, 101, {}}));
    world.send(gateway, test::serial_frame(started, serial::frame_type::packet));
    CHECK(written(40) == (may_be_own ? 1 : 0));
  }
}

TEST_CASE("a gateway has a line of its own to real motes, and takes those of its range alone",
          "[actors][gateway][GW-15][GW-17]") {
  fixture world;
  fake<peis_peer_actor> peer{world};
  fake<serial_line_actor> line{world};
  fake<serial_line_actor> real{world};
  fake<forwarder_server_actor> forwarder{world};
  fake<ecology_actor> ecology{world};
  gateway_arguments arguments;
  arguments.config.island = kitchen;
  arguments.config.has_real_line = true;
  arguments.plain.motes.rules = {{6, 100, 199, 901, 1, 2, 6, gateway::plain_form::blink}};
  arguments.plain.range = gateway::address_range{100, 199};
  arguments.plain.group = 0x22;
  arguments.peer = peer.handle();
  arguments.line = line.handle();
  arguments.real_line = real.handle();
  arguments.forwarder = forwarder.handle();
  arguments.ecology = ecology.handle();
  const auto gateway = world.spawn_at("gateway/kitchen", gateway_behavior, std::move(arguments));
  world.run_for(1ms);
  REQUIRE(real.count<watch_line>() == 1);
  CHECK(real.all<watch_line>()[0].takes_octets);
  CHECK(line.count<watch_line>() == 0);
  CHECK(real.count<serial_write>() == 0); // a base station is asked nothing
  line.forget();

  const auto told = [&](std::string_view key) {
    std::string value;
    for (const auto& x : peer.all<set_tuple>())
      if (x.key == key)
        value = x.text ? to_string(x.value.view()) : to_hex(x.value.view());
    return value;
  };
  const auto comes = [&](std::uint16_t source) {
    auto x = message(6);
    x.source = source;
    const auto frame = test::serial_frame(x, serial::frame_type::packet);
    world.send(gateway, real_octets{frame.octets});
  };
  for (const auto source : std::initializer_list<std::uint16_t>{99, 100, 199, 200})
    comes(source);
  CHECK(told("devices") == "{100,199}");
  CHECK(told("devices.100.output.1") == "010203");
  CHECK(told("devices.line").starts_with("silent")); // of its sink nothing has come
  CHECK(forwarder.count<serial_packet>() == 2);

  // What programs of TinyOS send goes where its destination is.
  const auto sent = [&](std::uint16_t to) {
    auto x = message(9);
    x.destination = to;
    world.send(gateway, serial_packet{to, payload(serial::encode(x))});
    world.run_for(1ms);
    const std::pair found{test::packets_in(line.all<serial_write>()).size(),
                          test::packets_in(real.all<serial_write>()).size()};
    for (const auto& frame : test::frames_in(real.all<serial_write>()))
      world.send(gateway, real_octets{serial::encode(
                              serial::frame{serial::frame_type::ack, frame.sequence, {}})});
    real.forget();
    return found;
  };
  CHECK(sent(100) == std::pair<std::size_t, std::size_t>{0, 1});
  CHECK(sent(199) == std::pair<std::size_t, std::size_t>{0, 1});
  CHECK(forwarder.count<serial_packet_done>() == 2);

  // An input is a packet of their program; that the base station has it is all that is known.
  world.send(gateway,
             tuple_event{1, gateway_of(kitchen), "devices.100.input.2", payload(bytes{0, 7})});
  CHECK(told("devices.100.input.2.status") == "1 pending");
  const auto packets = test::packets_in(real.all<serial_write>());
  REQUIRE(packets.size() == 1);
  CHECK(packets[0] == serial::am_packet{100, 0, 0x22, 6, bytes{0, 0, 0, 7}});
  const auto frames = test::frames_in(real.all<serial_write>());
  world.send(gateway, real_octets{serial::encode(
                          serial::frame{serial::frame_type::ack, frames[0].sequence, {}})});
  CHECK(told("devices.100.input.2.status") == "1 sent");
  world.send(gateway,
             tuple_event{1, gateway_of(kitchen), "devices.100.input.2", payload(bytes{0, 8})});
  world.run_for(5s); // nobody answers
  CHECK(told("devices.100.input.2.status") == "2 failed");

  world.send(gateway, serial_presence{false, {}});
  CHECK(told("devices.100.status").starts_with("stale"));
  world.run_for(30s);
  CHECK(told("devices") == "{100,199}"); // longer than they may be silent
  world.send(gateway, serial_presence{true, {}});
  comes(100);
  CHECK(told("devices.100.status").starts_with("listed"));
  ecology.forget();
  world.send(gateway, status_request{});
  const auto status = ecology.all<real_line_status>().at(0).real;
  CHECK(status.packets == 5);
  CHECK(status.taken == 3);
  CHECK(status.dropped == report::cause_counts{{"out_of_range", 2}});
  CHECK(status.inputs == 2);
  CHECK(status.inputs_sent == 1);
  CHECK(status.inputs_failed == report::cause_counts{{"no_ack", 1}});
}

TEST_CASE("plain motes behind a gateway's only line are spoken to over it, and outlast its loss",
          "[actors][gateway][GW-15][GW-17]") {
  fixture world;
  fake<peis_peer_actor> peer{world};
  fake<serial_line_actor> line{world};
  fake<ecology_actor> ecology{world};
  gateway_arguments arguments;
  arguments.config.island = kitchen;
  arguments.plain.motes.rules = {{6, 1, mote_id_max, 901, 1, 2, 6, gateway::plain_form::count}};
  arguments.plain.group = 0x22;
  arguments.peer = peer.handle();
  arguments.line = line.handle();
  arguments.line_is_real = true;
  arguments.ecology = ecology.handle();
  const auto gateway = world.spawn_at("gateway/kitchen", gateway_behavior, std::move(arguments));
  REQUIRE(line.count<watch_line>() == 1);
  CHECK(!line.all<watch_line>()[0].takes_octets);
  const auto told = [&](std::string_view key) {
    std::string value;
    for (const auto& x : peer.all<set_tuple>())
      if (x.key == key)
        value = to_string(x.value.view());
    return value;
  };
  const auto ack_all = [&] {
    for (const auto& x : test::frames_in(line.all<serial_write>()))
      world.send(gateway, serial_octets{serial::encode(
                              serial::frame{serial::frame_type::ack, x.sequence, {}})});
    line.forget();
  };
  ack_all();
  world.send(gateway, test::serial_frame(message(6), serial::frame_type::packet));
  CHECK(told("devices") == "{7}");
  CHECK(told("devices.line").starts_with("up")); // it is the only one
  world.send(gateway,
             tuple_event{1, gateway_of(kitchen), "devices.7.input.2", payload(bytes{1, 0})});
  const auto packets = test::packets_in(line.all<serial_write>());
  REQUIRE(packets.size() == 1);
  CHECK(packets[0] == serial::am_packet{7, 0, 0x22, 6, bytes{1, 0}});
  ack_all();
  CHECK(told("devices.7.input.2.status") == "1 sent");
  world.send(gateway, tuple_event{1, gateway_of(kitchen), "devices.7.input.2", payload(bytes{1})});
  CHECK(told("devices.7.input.2.status") == "2 failed"); // no number
  world.send(gateway, serial_presence{false, {}});
  world.run_for(20s);
  CHECK(told("devices.7.status").starts_with("stale"));
  CHECK(told("devices") == "{7}");
  world.send(gateway, serial_presence{true, {}});
  world.send(gateway, test::serial_frame(message(6), serial::frame_type::packet));
  CHECK(told("devices.7.status").starts_with("listed"));
  world.run_for(10s);
  CHECK(told("devices") == "{}"); // later it is silent
}

TEST_CASE("a replayed line says what was said, when it was said, and acks what it hears",
          "[actors][serial][ACT-08]") {
  fixture world;
  fake<ecology_actor> ecology{world};
  fake<serial_end_actor> pc{world};
  const serial::frame said{serial::frame_type::packet, 0, serial::encode(message(6))};
  const auto all = std::make_shared<const std::vector<serial::recorded_frame>>(
      std::vector<serial::recorded_frame>{
          {instant(2s), "kitchen", serial::direction::to_pc, said},
          {instant(3s), "kitchen", serial::direction::to_pc, said},
          {instant(4s), "kitchen", serial::direction::to_pc, said}});
  const auto line = world.spawn_at("serial_line/kitchen", replay_line, serial::replay(all, 1),
                                   kitchen, ecology.handle());
  world.send(line, attach_serial{serial::direction::to_pc, pc});
  world.run_for(2s);
  REQUIRE(pc.count<serial_octets>() == 1);
  CHECK(pc.times<serial_octets>()[0] == instant(2s));
  CHECK(pc.all<serial_octets>()[0].octets == payload(serial::encode(said)));

  serial::frame asked{serial::frame_type::packet_with_ack, 9, serial::encode(message(9))};
  world.send(line, serial_write{serial::direction::to_mote, payload(serial::encode(asked))});
  REQUIRE(pc.count<serial_octets>() == 2);
  CHECK(pc.all<serial_octets>()[1].octets ==
        payload(serial::encode(serial::frame{serial::frame_type::ack, 9, {}})));

  world.send(line, plug_serial{false});
  world.run_for(1s);
  CHECK(pc.count<serial_octets>() == 2);
  world.send(line, plug_serial{true});
  world.run_for(1s);
  CHECK(pc.count<serial_octets>() == 3);
  ecology.forget();
  world.send(line, status_request{});
  const auto status = ecology.all<serial_status>().at(0).serial;
  CHECK(status.lost.at("unplugged_octets") == serial::encode(said).size());
}
