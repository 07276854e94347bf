#include "mote/sink.hpp"
#include "network/am.hpp"
#include "network/island_packet.hpp"
#include "network/wire.hpp"
#include "support/catch.hpp"
#include "support/island_fixture.hpp"
#include "support/mote_ids.hpp"
#include "support/pick.hpp"
#include "support/segments.hpp"
#include "transport/fragments.hpp"

using namespace rubicon;
using namespace rubicon::mote;
using test::island_fixture;
using test::pick;
using test::the_island;

namespace {

constexpr mote_id lamp{2};

sink make_sink() {
  registrar_config config;
  config.island = the_island;
  network::router_config network;
  network.self = island_fixture::sink_id;
  return {network, config, duty_config{}, random_stream(1), {}};
}

std::unique_ptr<island_fixture> with_lamp() {
  auto world = std::make_unique<island_fixture>(
      test::island_fixture_config{.width = 2, .island = the_island});
  auto& x = *world;
  REQUIRE(x.run_until([&x] { return x.root().members() == 1; }, 1min));
  x.run_for(5s);
  x.up.clear();
  return world;
}

} // namespace

TEST_CASE("a sink passes island packets up and down as they are", "[mote][RTG-02]") {
  const auto world = with_lamp();
  auto& x = *world;
  REQUIRE(x.send(lamp, {island_id{2}, mote_id{5}}, 10, bytes{'h', 'i'}, false));
  x.run_for(1s);
  REQUIRE(x.up.size() == 1);
  CHECK(x.up[0].source == lamp);
  CHECK(x.up[0].am_type == network::am::to_gateway);
  const auto packet = network::decode_island_packet(x.up[0].payload);
  REQUIRE(packet);
  CHECK(*packet == network::island_packet{island_id{2}, mote_id{5}, 10,
                                          encode(test::plain(lamp, 10, bytes{'h', 'i'}))});
  x.down(network::am::from_gateway,
         encode(network::island_packet{island_id{2}, lamp, 11,
                                       encode(test::plain(mote_id{5}, 11, bytes{'j', 'o'}))}));
  x.run_for(1s);
  REQUIRE(x.received.size() == 1);
  CHECK(x.received[0].first == lamp);
  CHECK(x.received[0].second.source == mote_address{island_id{2}, mote_id{5}});
  CHECK(x.received[0].second.am_type == 11);
  CHECK(x.received[0].second.payload == bytes{'j', 'o'});
  CHECK(x.root().counters().up == 1);
  CHECK(x.root().counters().down == 1);
}

TEST_CASE("long packets cross the serial line in fragments that fit it", "[mote][NET-14][WIR-04]") {
  const auto world = with_lamp();
  auto& x = *world;
  const bytes text(256, 'x');
  REQUIRE(x.send(lamp, {island_id{2}, mote_id{5}}, 10, text, false));
  x.run_for(1s);
  REQUIRE(x.up.size() == 3);
  transport::assembly gateway;
  std::optional<bytes> whole;
  for (const auto& fragment : x.up) {
    CHECK(fragment.am_type == network::am::packet);
    CHECK(fragment.source == lamp);
    CHECK(fragment.payload.size() <= network::frame_payload_max);
    whole = gateway.on_fragment(fragment.source, fragment.payload, x.now());
  }
  REQUIRE(whole);
  CHECK(transport::decode_segment(network::decode_island_packet(*whole)->body)->payload == text);

  const auto down = encode(
      network::island_packet{island_id{2}, lamp, 10, encode(test::plain(mote_id{5}, 10, text))});
  const auto fragments = transport::cut(down, network::frame_payload_max, 3);
  for (const auto& fragment : *fragments)
    x.down(network::am::packet, fragment);
  x.run_for(1s);
  REQUIRE(x.received.size() == 1);
  CHECK(x.received[0].second.payload == text);
  CHECK(x.longest <= network::frame_payload_max);
}

TEST_CASE("a sink drops and counts what it cannot read", "[mote]") {
  auto x = make_sink();
  CHECK(x.on_packet(network::am::from_gateway, bytes{0}, {}).empty());
  CHECK(x.on_packet(network::am::sink_event, bytes{9}, {}).empty());
  CHECK(x.on_packet(network::am::sink_event, encode(network::sink_event(network::roster{})), {})
            .empty());
  CHECK(x.on_packet(0x77, {}, {}).empty());
  CHECK(x.on_packet(network::am::packet, bytes{0, 1, 2}, {}).empty());
  CHECK(x.counters().malformed == 4);
  CHECK(x.counters().unknown_type == 1);
}

TEST_CASE("a packet for a mote to which a sink knows no route is dropped and counted",
          "[mote][RTG-05]") {
  auto x = make_sink();
  CHECK(x.on_packet(network::am::from_gateway,
                    encode(network::island_packet{island_id{2}, mote_id{9}, 10, bytes{1}}), {})
            .empty());
  CHECK(x.packets().counters().unroutable == 1);
}

TEST_CASE("what is for the sink itself goes no further", "[mote]") {
  const auto world = with_lamp();
  auto& x = *world;
  REQUIRE(x.send(lamp, {own_island, island_fixture::sink_id}, 10, bytes{1}, false));
  x.run_for(1s);
  CHECK(x.up.empty());
  CHECK(x.root().counters().for_sink == 1);
}

TEST_CASE("a sink answers its gateway's question about a mote", "[mote][GW-15]") {
  auto x = make_sink();
  const auto out = pick<to_gateway>(x.on_packet(
      network::am::sink_event, encode(network::sink_event(network::describe{mote_id{7}})), {}));
  REQUIRE(out.size() == 1);
  CHECK(out[0].source == mote_id{1});
  CHECK(to_hex(out[0].payload) == "02000702");
}

TEST_CASE("a sink asks for the time and gives it to its island's clock", "[mote][CLK-08]") {
  auto x = make_sink();
  static_cast<void>(x.start({}));
  std::vector<to_gateway> asked;
  instant now;
  const auto run_until = [&](instant end) {
    while (x.deadline() <= end) {
      const auto at = x.deadline();
      for (auto& y : pick<to_gateway>(x.on_time(at))) {
        const auto event = network::decode_sink_event(y.payload);
        if (event && std::holds_alternative<network::time_request>(*event)) {
          asked.push_back(y);
          now = at;
        }
      }
    }
  };
  run_until(instant(1s));
  REQUIRE(asked.size() == 1);
  CHECK(asked[0].source == island_fixture::sink_id);
  CHECK(asked[0].am_type == network::am::sink_event);
  CHECK(asked[0].urgent);
  CHECK(asked[0].asks_time);
  CHECK_FALSE(x.time().at(instant(1s)));
  const auto number =
      std::get<network::time_request>(*network::decode_sink_event(asked[0].payload)).number;
  static_cast<void>(x.on_packet(network::am::sink_event,
                                encode(network::sink_event(network::time_answer{number, 1000s})),
                                instant(1s + 10ms)));
  CHECK(x.time().at(instant(1s + 5ms)) == 1000s);
  run_until(instant(4s));
  CHECK(x.packets().router().clock().network_time(instant(4s)) == 1003s - 5ms);

  run_until(instant(5s)); // the line is in use for 80 ms, later for 40 ms that the answer gives
  REQUIRE(asked.size() > 1);
  x.on_question_delayed(80ms);
  const auto last =
      std::get<network::time_request>(*network::decode_sink_event(asked.back().payload)).number;
  static_cast<void>(x.on_packet(
      network::am::sink_event,
      encode(network::sink_event(network::time_answer{last, 1003s + 80ms, 40ms})), now + 130ms));
  CHECK(x.time().counters().answered == 2);
  CHECK(x.time().counters().slow == 0);
}

TEST_CASE("fragments of packets of two motes do not mix", "[mote][NET-14]") {
  network::router_config network;
  network.self = island_fixture::sink_id;
  network.is_sink = true;
  packet_service x(network, random_stream(1), {});
  const auto cut = [](char octet) {
    const auto value = static_cast<std::uint8_t>(octet);
    return *transport::cut(encode(network::island_packet{the_island, lamp, 10, bytes(50, value)}),
                           40,
                           7); // each mote counts its packets from the same number
  };
  std::vector<bytes> whole;
  const auto hear = [&](std::uint16_t mote, const bytes& fragment) {
    bytes content{network::am::packet};
    content.insert(content.end(), fragment.begin(), fragment.end());
    const network::content_in arrived{mote_id{mote}, false, std::move(content)};
    for (const auto& each : pick<packet_in>(x.carry({arrived}, {})))
      whole.push_back(each.packet.body);
  };
  const auto a = cut('a');
  const auto b = cut('b');
  REQUIRE(a.size() == b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    hear(3, a[i]);
    hear(4, b[i]);
  }
  CHECK(whole == std::vector{bytes(50, 'a'), bytes(50, 'b')});
}
