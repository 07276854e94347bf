// A PC's own end of the Communication Layer.
#include "communication/pc.hpp"

#include "network/island_packet.hpp"
#include "support/catch.hpp"
#include "support/placements_fixture.hpp"
#include "support/segments.hpp"

using namespace rubicon;
using test::recorder;

namespace {

const mote_address pc_address{island_id{20}, no_mote};

struct lone_pc {
  lone_pc() : core({.self = peer_id{20}}, random_stream(1)) {
    program.layer = core.attach(program);
  }

  /// What another peer's layer or gateway would send.
  communication::outputs hear(peer_id from, mote_id to, const bytes& segment) {
    return core.on_message(from, encode(network::gateway_packet{to, 10, segment}), now);
  }

  recorder program;
  communication::pc core;
  instant now;
};

} // namespace

TEST_CASE("a PC is joined when it starts, under its PEIS id",
          "[communication][MCK-13][MCK-16][ADR-07]") {
  lone_pc x;
  CHECK(x.program.layer->send(2, 3, bytes{1}, false, 10) == communication::FAIL);
  CHECK(!x.program.layer->address());
  CHECK(x.core.flush().empty());
  CHECK(x.core.start(x.now).empty());
  CHECK(x.program.inits == std::vector{true});
  CHECK(x.program.joins == std::vector{std::pair(pc_address, true)});
  CHECK(x.program.layer->address() == pc_address);
  CHECK(x.program.layer->send(2, 3, bytes{1}, false, 10) == communication::SUCCESS);
  const auto packets = x.core.flush();
  REQUIRE(packets.size() == 1);
  const auto sent = communication::message_of(packets[0]);
  CHECK(sent.peer == peer_id{2});
  const auto packet = network::decode_gateway_packet(sent.octets);
  REQUIRE(packet);
  CHECK(packet->mote == mote_id{3});
  CHECK(packet->channel == 10);
}

TEST_CASE("a PC drops and counts what is malformed, for a mote, or of an unknown type",
          "[communication][AM-01][AM-05]") {
  lone_pc x;
  CHECK(x.core.start(x.now).empty());
  CHECK(x.core.on_message(peer_id{21}, bytes{1, 2, 3}, x.now).empty());
  CHECK(x.hear(peer_id{0}, no_mote, encode(test::plain(no_mote, 10, bytes{1}))).empty());
  CHECK(x.core.counters().malformed == 2);
  CHECK(x.hear(peer_id{21}, mote_id{4}, encode(test::plain(no_mote, 10, bytes{1}))).empty());
  CHECK(x.core.counters().misdirected == 1);
  CHECK(x.hear(peer_id{21}, no_mote, encode(test::plain(no_mote, 10, bytes{1}))).empty());
  CHECK(x.core.above().counters().unowned == 1);
  CHECK(x.program.messages.empty());
  REQUIRE(x.program.layer->provide(10) == communication::SUCCESS);
  CHECK(x.hear(peer_id{21}, no_mote, encode(test::plain(no_mote, 10, bytes{1}))).empty());
  CHECK(x.program.messages.size() == 1);
}

TEST_CASE("a PC reaches itself without a message", "[communication][ADR-03][ADR-06][STR-11]") {
  lone_pc x;
  CHECK(x.core.start(x.now).empty());
  REQUIRE(x.program.layer->provide(10) == communication::SUCCESS);
  CHECK(x.program.layer->send(255, own_mote.value, bytes{7}, true, 10) == communication::SUCCESS);
  CHECK(x.core.flush().empty());
  REQUIRE(x.program.messages.size() == 1);
  CHECK(x.program.messages[0].source == pc_address);
  CHECK(x.program.acks == std::vector{true});
}

TEST_CASE("a PC's clock ticks from 0 on, once in a period", "[communication][SYN-11][CLK-03]") {
  lone_pc x;
  CHECK(x.core.start(x.now).empty());
  while (x.now < instant{} + 5s) {
    REQUIRE(x.core.deadline());
    x.now = *x.core.deadline();
    CHECK(x.core.on_time(x.now).empty());
  }
  REQUIRE(x.program.ticks.size() == 11);
  for (std::uint32_t i = 0; i < 11; ++i) {
    CHECK(x.program.ticks[i].first == i);
    CHECK(x.program.ticks[i].second == instant{} + i * 500ms);
  }
}

TEST_CASE("a PC has no transducers", "[communication][MCK-03][STR-09]") {
  lone_pc x;
  CHECK(x.core.start(x.now).empty());
  for (std::uint8_t i = 0; i < 40; ++i)
    CHECK(x.program.layer->open_sensor(i, 1000, stream::sampling::periodic) == -1);
  CHECK(x.core.above().counters().refused == 40);
}

TEST_CASE("communications of a PC start while its line is up", "[communication][MCK-13][MCK-14]") {
  lone_pc x;
  CHECK(x.core.start(x.now).empty());
  const auto init = [&] {
    CHECK(x.program.layer->initCommunications() == communication::SUCCESS);
    CHECK(x.core.flush().empty());
    return x.program.inits.back();
  };
  CHECK(init());
  CHECK(x.program.inits.size() == 2);
  x.core.set_line(false);
  CHECK_FALSE(init());
  CHECK(x.program.layer->joinIsland(bytes{1}) == communication::FAIL);
  x.core.set_line(true);
  CHECK(init());
  CHECK(x.program.layer->joinIsland(bytes{1}) == communication::SUCCESS);
  CHECK(x.core.flush().empty());
  CHECK(x.program.joins == std::vector{std::pair(pc_address, true), std::pair(pc_address, true)});
}
