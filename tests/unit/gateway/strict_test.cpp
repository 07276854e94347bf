// A gateway among gateways that speak D1.1 5.4 to the letter.
#include "gateway/gateway.hpp"
#include "network/am.hpp"
#include "network/island_packet.hpp"
#include "support/catch.hpp"
#include "support/pick.hpp"
#include "support/segments.hpp"
#include "transport/segment.hpp"
#include "unit/gateway/fixture.hpp"

using namespace rubicon;
using gateway::to_gateway;
using gateway::to_sink;
using test::fan;
using test::pick;
using test::plain;
using test::reliable;

namespace {

constexpr island_id bedroom{2};

gateway::gateway with_fan(wire_form form) {
  gateway::gateway x({.island = island_id{1}, .form = form}, random_stream(1));
  static_cast<void>(x.start({}));
  static_cast<void>(
      x.on_packet(mote_id{1}, network::am::sink_event,
                  network::encode(network::sink_event{network::mote_joined{fan, 0, 301, {}}}), {}));
  return x;
}

gateway::outputs send_up(gateway::gateway& x, const transport::segment& segment,
                         std::uint16_t channel) {
  return x.on_packet(fan, network::am::to_gateway,
                     encode(network::island_packet{bedroom, mote_id{5}, channel, encode(segment)}),
                     {});
}

} // namespace

TEST_CASE("messages to a gateway of another make are the bytes of D1.1 5.4",
          "[gateway][WIR-02][WIR-04][WIR-01]") {
  const bool by_discovery = GENERATE(true, false);
  auto x = with_fan(by_discovery ? wire_form::segment : wire_form::strict54);
  if (by_discovery)
    static_cast<void>(x.on_message(peer_id{2}, gateway::announcement_port, bytes{'?'}, {}));
  const auto sent = pick<to_gateway>(send_up(x, plain(fan, 1, bytes{'h', 'i'}), 1));
  REQUIRE(sent.size() == 1);
  CHECK(sent[0].peer == peer_id{2});
  CHECK(to_hex(sent[0].octets) == "000500016869");

  CHECK(pick<to_gateway>(send_up(x, reliable(fan, 1, 1, bytes{'h', 'i'}), 1)).empty());
  CHECK(pick<to_gateway>(send_up(x, plain(fan, 1, bytes{1}), 300)).empty());
  CHECK(x.counters().unsayable == 2);
}

TEST_CASE("messages from a gateway of another make reach their mote as from an unknown one",
          "[gateway][WIR-04]") {
  auto x = with_fan(wire_form::segment);
  static_cast<void>(x.on_message(peer_id{2}, gateway::announcement_port, bytes{'?'}, {}));
  const auto said = *from_hex("000700016869");
  const auto first =
      pick<to_sink>(x.on_message(peer_id{2}, communication::island_message_port, said, {}));
  REQUIRE(first.size() == 1);
  const auto packet = network::decode_island_packet(first[0].payload);
  REQUIRE(packet);
  CHECK(packet->island == bedroom);
  CHECK(packet->mote == fan);
  const auto segment = transport::decode_segment(packet->body);
  REQUIRE(segment);
  CHECK(segment->source == no_mote);
  CHECK(segment->am_type == 1);
  CHECK(segment->payload == bytes{'h', 'i'});
  const auto second =
      pick<to_sink>(x.on_message(peer_id{2}, communication::island_message_port, said, {}));
  REQUIRE(second.size() == 1);
  CHECK(second[0].payload != first[0].payload); // not a repetition
  CHECK(x.on_message(peer_id{2}, communication::island_message_port, *from_hex("0007012c6869"), {})
            .empty());
  CHECK(x.counters().unsayable == 1);
}

TEST_CASE("two gateways told to speak 5.4 to the letter understand each other",
          "[gateway][WIR-04]") {
  auto a = with_fan(wire_form::strict54);
  auto b = with_fan(wire_form::strict54);
  const auto sent = pick<to_gateway>(send_up(a, plain(fan, 10, bytes{1, 2, 3}), 10));
  REQUIRE(sent.size() == 1);
  auto octets = sent[0].octets;
  octets[1] = 7; // b's mote
  const auto down =
      pick<to_sink>(b.on_message(peer_id{1}, communication::island_message_port, octets, {}));
  REQUIRE(down.size() == 1);
  CHECK(transport::decode_segment(network::decode_island_packet(down[0].payload)->body)->payload ==
        bytes{1, 2, 3});
}

TEST_CASE("an island is left through any gateway of the other one", "[gateway][GW-14]") {
  auto x = with_fan(wire_form::segment);
  static_cast<void>(x.on_message(peer_id{102}, gateway::announcement_port,
                                 encode(gateway::announcement{bedroom}), {}));
  CHECK(pick<to_gateway>(send_up(x, plain(fan, 1, bytes{1}), 1))[0].peer == peer_id{102});
  static_cast<void>(x.on_message(peer_id{2}, gateway::announcement_port,
                                 encode(gateway::announcement{bedroom}), {}));
  CHECK(pick<to_gateway>(send_up(x, plain(fan, 1, bytes{1}), 1))[0].peer == peer_id{2});
  x.on_unreachable(peer_id{2});
  CHECK(pick<to_gateway>(send_up(x, plain(fan, 1, bytes{1}), 1))[0].peer == peer_id{102});
  const auto message =
      encode(network::gateway_packet{fan, 1, encode(plain(mote_id{5}, 1, bytes{1}))});
  const auto down =
      pick<to_sink>(x.on_message(peer_id{102}, communication::island_message_port, message, {}));
  REQUIRE(down.size() == 1);
  CHECK(network::decode_island_packet(down[0].payload)->island == bedroom);
}
