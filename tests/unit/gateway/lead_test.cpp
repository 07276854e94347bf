// One gateway among several of an island.
#include "core/tuples/device_keys.hpp"
#include "gateway/gateway.hpp"
#include "network/am.hpp"
#include "network/island_packet.hpp"
#include "support/catch.hpp"
#include "support/pick.hpp"
#include "support/segments.hpp"
#include "transport/segment.hpp"
#include "unit/gateway/fixture.hpp"

using namespace rubicon;
using gateway::answer_sink;
using gateway::leadership;
using gateway::publish;
using gateway::relay_to;
using gateway::to_sink;
using kind = transport::segment::kind;
using test::deliver;
using test::fan;
using test::join;
using test::pick;
using test::published;

namespace {

constexpr island_id shared_kitchen{20};
constexpr peer_id first{20};
constexpr peer_id second{21};

gateway::gateway make_standby(std::uint32_t life = 0) {
  gateway::gateway_config config;
  config.island = shared_kitchen;
  config.gateways = {first, second};
  config.incarnation = life;
  gateway::gateway x(config, random_stream(1));
  static_cast<void>(x.start({}));
  return x;
}

gateway::outputs lead(gateway::gateway& x, std::uint32_t term = 1, instant now = {}) {
  return deliver(x, network::gateway_poll{0, term, true}, now);
}

/// That another gateway says it leads.
void hear_leader(gateway::gateway& x, peer_id who) {
  static_cast<void>(
      x.on_message(who, gateway::announcement_port,
                   encode(gateway::announcement{shared_kitchen, wire_form::segment, 0, true}), {}));
}

gateway::outputs send_up(gateway::gateway& x, const transport::segment& segment) {
  return x.on_packet(
      fan, network::am::to_gateway,
      encode(network::island_packet{shared_kitchen, no_mote, segment.am_type, encode(segment)}),
      {});
}

/// The only segment that goes down.
transport::segment first_segment_down(const gateway::outputs& out) {
  for (const auto& x : pick<to_sink>(out)) {
    if (x.am_type == network::am::from_gateway)
      return *transport::decode_segment(network::decode_island_packet(x.payload)->body);
  }
  FAIL("nothing goes down");
  return {};
}

} // namespace

TEST_CASE("a gateway leads while its sink says so", "[gateway][GW-14]") {
  leadership x({.alone = false, .life = 3, .lease = 1500ms});
  CHECK(!x.leads());
  CHECK(x.on_poll({network::unknown_life, 1, true}, {}) == leadership::change::none);
  CHECK(x.answer() == network::gateway_answer{3, 1});
  CHECK(x.on_poll({3, 1, true}, instant{20ms}) == leadership::change::taken);
  CHECK(x.leads());
  CHECK(x.on_poll({3, 1, true}, instant{1s}) == leadership::change::none);
  CHECK(x.on_time(instant{2499ms}) == leadership::change::none);
  SECTION("its lease runs out") {
    CHECK(x.deadline() == instant{2500ms});
    CHECK(x.on_time(instant{2500ms}) == leadership::change::lost);
    CHECK(!x.deadline());
    CHECK(x.leading(instant{1h}) == 2480ms);
  }
  SECTION("another one leads") {
    CHECK(x.on_poll({3, 2, false}, instant{2s}) == leadership::change::lost);
    CHECK(x.on_poll({3, 2, false}, instant{3s}) == leadership::change::none);
    CHECK(x.answer().term == 2);
  }
  SECTION("it is taken for an earlier life") {
    CHECK(x.on_poll({2, 2, true}, instant{2s}) == leadership::change::lost);
  }
  SECTION("a new term begins") {
    CHECK(x.on_poll({3, 2, true}, instant{2s}) == leadership::change::taken);
    CHECK(x.led() == 2);
    CHECK(x.leading(instant{2s}) == 1980ms);
  }
}

TEST_CASE("an only gateway always leads, and answers no polls", "[gateway][GW-14]") {
  CHECK(leadership(gateway::leadership_config{}).leads());
  gateway::gateway_config config;
  config.island = shared_kitchen;
  gateway::gateway x(config, random_stream(1));
  CHECK(published(x.start({}), "devices.role") == "nothing");
  CHECK(pick<answer_sink>(lead(x)).empty());
  CHECK(x.counters().unknown_type == 1);
}

TEST_CASE("a gateway that stands by knows the motes and publishes no outputs",
          "[gateway][GW-14][GW-03]") {
  auto x = make_standby();
  const auto out = x.start({});
  CHECK(published(out, "devices.role") == "stands_by 0.000000");
  CHECK(published(out, "devices.gateways") == "{20,21}");
  join(x, fan);
  CHECK(x.devices() == std::vector{fan});
  CHECK(pick<publish>(send_up(x, test::plain(fan, 1, bytes{5}))).empty());
  CHECK(x.counters().undeliverable == 1);
  CHECK(published(lead(x), "devices.role") == "leads 0.000000");
  CHECK(published(send_up(x, test::plain(fan, 1, bytes{5})), "devices.7.output.1") == "05");
}

TEST_CASE("its output tuples and what was in flight end with the lead", "[gateway][GW-14][IF-07]") {
  auto x = make_standby();
  join(x, fan);
  static_cast<void>(lead(x));
  static_cast<void>(send_up(x, test::plain(fan, 1, bytes{5})));
  CHECK(published(x.on_input(fan, 2, bytes{1}, {}), "devices.7.input.2.status") == "1 pending");
  const auto out = x.on_time(instant{1500ms});
  CHECK(published(out, "devices.role") == "stands_by 1.500000");
  CHECK(published(out, "devices.7.input.2.status") == "1 failed");
  REQUIRE(pick<gateway::erase>(out).size() == 1);
  CHECK(pick<gateway::erase>(out)[0].key == "devices.7.output.1");
  CHECK(x.devices() == std::vector{fan});
  static_cast<void>(lead(x, 2, instant{2s}));
  const auto counted = x.pc().layer_counters().transport; // every reliable message has an end
  CHECK(counted.reliable_sent == 1);
  CHECK(counted.reliable_failed == 1);
  CHECK(x.pc().outstanding() == 0);
}

TEST_CASE("each term is another incarnation of the PC of the island", "[gateway][GW-14][MCK-11]") {
  auto x = make_standby();
  join(x, fan);
  static_cast<void>(lead(x, 1));
  const auto answer = first_segment_down(send_up(x, test::hello(fan, 0, 64)));
  CHECK(answer.receiver == 1);
  static_cast<void>(x.on_time(instant{2s}));
  static_cast<void>(lead(x, 3, instant{2s}));
  // what another one was sent is not taken for ours
  auto late = test::reliable(fan, 1, 64, bytes{1});
  late.receiver = 2;
  CHECK(first_segment_down(send_up(x, late)).what == kind::refused);
  CHECK(first_segment_down(send_up(x, test::hello(fan, 2, 64))).receiver == 3);
}

TEST_CASE("who stands by passes inputs on and tells their outcomes", "[gateway][GW-14][IF-07]") {
  auto standby = make_standby();
  join(standby, fan);
  SECTION("nobody leads") {
    const auto out = standby.on_input(fan, 2, bytes{1}, {});
    CHECK(published(out, "devices.7.input.2.status") == "1 unreachable");
  }
  SECTION("another one leads") {
    hear_leader(standby, first);
    auto leader = make_standby();
    join(leader, fan);
    static_cast<void>(lead(leader));
    const auto asked = standby.on_input(fan, 2, bytes{1}, {});
    CHECK(published(asked, "devices.7.input.2.status") == "1 pending");
    const auto relays = pick<relay_to>(asked);
    REQUIRE(relays.size() == 1);
    CHECK(relays[0].peer == first);
    const auto down =
        first_segment_down(leader.on_message(second, gateway::relay_port, relays[0].octets, {}));
    CHECK(down.what == kind::hello);
    auto answered = send_up(leader, test::acknowledgement(fan, down));
    answered = send_up(leader, test::acknowledgement(fan, first_segment_down(answered)));
    const auto back = pick<relay_to>(answered);
    REQUIRE(back.size() == 1);
    CHECK(back[0].peer == second);
    CHECK(published(standby.on_message(first, gateway::relay_port, back[0].octets, {}),
                    "devices.7.input.2.status") == "1 acknowledged");
    CHECK(
        standby.on_message(first, gateway::relay_port, back[0].octets, {}).empty()); // one outcome
  }
  SECTION("the one that led has ended") {
    hear_leader(standby, first);
    static_cast<void>(standby.on_input(fan, 2, bytes{1}, {}));
    CHECK(published(standby.on_time(instant{34s}), "devices.7.input.2.status") == "nothing");
    CHECK(published(standby.on_time(instant{35s}), "devices.7.input.2.status") == "1 failed");
  }
  SECTION("who is asked does not lead either") {
    const auto asked = encode(gateway::relay(gateway::relayed_input{4, fan, 2, bytes{1}}));
    const auto back = pick<relay_to>(standby.on_message(first, gateway::relay_port, asked, {}));
    REQUIRE(back.size() == 1);
    CHECK(*gateway::decode_relay(back[0].octets) ==
          gateway::relay(gateway::relayed_outcome{4, input_outcome::unreachable}));
  }
}

TEST_CASE("a message to either gateway arrives", "[gateway][GW-14]") {
  auto standby = make_standby();
  auto leader = make_standby();
  join(standby, fan);
  join(leader, fan);
  static_cast<void>(lead(leader));
  const auto message =
      encode(network::gateway_packet{fan, 10, encode(test::plain(mote_id{3}, 10, bytes{9}))});
  CHECK(standby.on_message(peer_id{30}, communication::island_message_port, message, {})
            .empty()); // nobody is known to lead
  hear_leader(standby, first);
  const auto relays = pick<relay_to>(
      standby.on_message(peer_id{30}, communication::island_message_port, message, {}));
  REQUIRE(relays.size() == 1);
  const auto down =
      pick<to_sink>(leader.on_message(second, gateway::relay_port, relays[0].octets, {}));
  REQUIRE(down.size() == 1);
  CHECK(down[0].mote == fan);
  CHECK(network::decode_island_packet(down[0].payload)->island == island_id{30});
  CHECK(standby.on_message(first, gateway::relay_port, relays[0].octets, {})
            .empty()); // does not go round
  CHECK(leader.on_message(peer_id{30}, gateway::relay_port, relays[0].octets, {}).empty());
  CHECK(leader.counters().malformed == 1);
}

TEST_CASE("motes may call their island by any of its ids", "[gateway][GW-14]") {
  auto x = make_standby();
  join(x, fan);
  static_cast<void>(lead(x));
  const auto out = x.on_packet(
      fan, network::am::to_gateway,
      encode(network::island_packet{island_id{21}, fan, 10, encode(test::plain(fan, 10, {}))}), {});
  REQUIRE(pick<to_sink>(out).size() == 1);
  CHECK(pick<to_sink>(out)[0].mote == fan);
}

TEST_CASE("who takes the lead asks motes for their outputs anew", "[gateway][GW-14][GW-10]") {
  auto x = make_standby();
  join(x, fan);
  x.on_subscribers(std::vector<std::string>{"devices.7.output.1"}, {});
  CHECK(pick<to_sink>(x.on_time(instant{1s})).empty()); // it is for the other one to ask
  static_cast<void>(lead(x, 2, instant{1s}));
  CHECK(first_segment_down(x.on_time(instant{1s})).am_type == network::am::outputs_wanted);
}

TEST_CASE("relays have their octets", "[gateway][GW-14]") {
  using gateway::decode_relay;
  using gateway::relay;
  const std::pair<relay, std::string> rows[] = {
      {gateway::relayed_message{island_id{30}, {fan, 10, bytes{1, 2}}}, "010000001e0007000a0102"},
      {gateway::relayed_input{5, fan, 2, bytes{1}}, "02000000050007000201"},
      {gateway::relayed_outcome{5, input_outcome::acknowledged}, "030000000501"},
  };
  for (const auto& [x, octets] : rows) {
    CHECK(to_hex(encode(x)) == octets);
    CHECK(*decode_relay(*from_hex(octets)) == x);
  }
  CHECK(decode_relay({}).error() == errc::truncated);
  CHECK(decode_relay(*from_hex("04")).error() == errc::unsupported);
  CHECK(decode_relay(*from_hex("01000000000007000a")).error() == errc::bad_value);
  CHECK(decode_relay(*from_hex("030000000500")).error() == errc::bad_value);
  CHECK(decode_relay(*from_hex("030000000504")).error() == errc::bad_value);
  CHECK(decode_relay(*from_hex("03000000050101")).error() == errc::too_long);
  CHECK(decode_relay(*from_hex("0200000005")).error() == errc::truncated);
}

TEST_CASE("answers to what was sent to an alias come from it", "[gateway][GW-14]") {
  gateway::alias_talks x;
  const mote_id caller{3};
  auto said = test::reliable(caller, 5, 10, bytes{1});
  x.note(island_id{21}, shared_kitchen, fan, encode(said));
  const auto answer = test::acknowledgement(fan, said);
  CHECK(x.source_of(shared_kitchen, caller, encode(answer)) == island_id{21});
  CHECK(x.source_of(shared_kitchen, mote_id{4}, encode(answer)) == shared_kitchen);
  said.counter = 6;
  CHECK(x.source_of(shared_kitchen, caller, encode(test::acknowledgement(fan, said))) ==
        shared_kitchen);
  CHECK(x.source_of(shared_kitchen, caller, encode(test::plain(fan, 10, bytes{1}))) ==
        shared_kitchen);
  for (std::uint16_t i = 0; i < gateway::alias_talks::talks_max; ++i) // the oldest is forgotten
    x.note(island_id{21}, shared_kitchen, fan,
           encode(test::reliable(caller, 100 + i, 10, bytes{1})));
  CHECK(x.source_of(shared_kitchen, caller, encode(answer)) == shared_kitchen);
}
