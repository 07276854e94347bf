// Sinks and motes over several hops.
#include <set>

#include "network/am.hpp"
#include "network/wire.hpp"
#include "support/catch.hpp"
#include "support/island_fixture.hpp"
#include "support/mote_ids.hpp"
#include "support/programs.hpp"
#include "support/seeds.hpp"
#include "support/segments.hpp"

using namespace rubicon;
using test::id;
using test::island_fixture;
using test::island_fixture_config;

namespace {

/// Everybody is a member, and neighbours and the sink know where everybody is.
std::unique_ptr<island_fixture> settled(const island_fixture_config& config) {
  auto world = std::make_unique<island_fixture>(config);
  auto& x = *world;
  const auto motes = static_cast<std::size_t>(config.width * config.height) - 1;
  REQUIRE(x.run_until([&] { return x.root().members() == motes; }, 3min));
  x.run_for(1min);
  x.up.clear();
  x.received.clear();
  x.outcomes.clear();
  return world;
}

std::size_t count_of_packets_up(const island_fixture& x) {
  return static_cast<std::size_t>(std::ranges::count_if(x.up, [](const auto& each) {
    return each.am_type == network::am::to_gateway || each.am_type == network::am::packet;
  }));
}

} // namespace

TEST_CASE("motes join over three hops", "[mote][network][NET-11][DIS-08]") {
  island_fixture x({.width = 4});
  REQUIRE(x.run_until([&x] { return x.root().members() == 3; }, 1min));
  std::set<mote_id> joined;
  for (const auto& each : x.up) {
    const auto event = network::decode_sink_event(each.payload);
    if (event && std::holds_alternative<network::mote_joined>(*event))
      joined.insert(std::get<network::mote_joined>(*event).mote);
  }
  CHECK(joined == std::set{id(2), id(3), id(4)});
  CHECK(x.at(id(4)).packets().router().tree().hops() == 3);
  x.run_for(10min);
  CHECK(x.root().members() == 3);
  CHECK(x.memberships.size() == 3); // none was lost in between
}

TEST_CASE("a mote that has joined knows all ids of its island's gateways",
          "[mote][NFR-05][GW-14]") {
  island_fixture x({.width = 3, .aliases = {island_id{21}, island_id{22}}});
  CHECK(x.at(id(3)).member().gateways().empty());
  REQUIRE(x.run_until([&x] { return x.root().members() == 2; }, 1min));
  x.run_for(1s);
  CHECK(x.at(id(3)).member().gateways() == std::vector{peer_id{1}, peer_id{21}, peer_id{22}});
}

TEST_CASE("a mote that has joined knows its island, its sink and the route to its gateway",
          "[mote][NFR-05]") {
  island_fixture x({.width = 3});
  test::recorder program;
  program.layer = x.at(id(3)).attach(program);
  CHECK(!program.layer->address());
  REQUIRE(x.run_until([&x] { return x.root().members() == 2; }, 1min));
  x.run_for(1s);
  const auto self = program.layer->address();
  REQUIRE(self);
  CHECK(*self == mote_address{island_id{1}, id(3)});
  CHECK(x.at(id(3)).member().gateways() == std::vector{peer_id{1}});
  const auto& tree = x.at(id(3)).packets().router().tree();
  CHECK(tree.root() == id(1));
  CHECK(tree.parent() == id(2));
  x.up.clear();
  test::act(x, id(3), [&] { // the PC of its own island, whatever its PEIS id
    return program.layer->send_numbered({own_island, no_mote}, bytes{1}, false, 64);
  });
  x.run_for(5s);
  CHECK(std::ranges::any_of(
      x.up, [](const auto& each) { return each.am_type == network::am::to_gateway; }));
}

TEST_CASE("motes join over lossy hops, and stay members", "[mote][network][DIS-06][DIS-08]") {
  for (std::uint64_t seed = 1; seed <= test::seeds(5); ++seed) {
    island_fixture x({.width = 4, .height = 3, .delivery = 0.8, .seed = seed});
    CHECK(x.run_until([&x] { return x.root().members() == 11; }, 2min));
    x.run_for(10min);
    CHECK(x.root().members() == 11);
  }
}

TEST_CASE("a message of 256 octets crosses three hops up, down and between motes",
          "[mote][network][NET-14][MCK-09]") {
  const auto world = settled({.width = 4});
  auto& x = *world;
  bytes text(256);
  for (std::size_t i = 0; i < text.size(); ++i)
    text[i] = static_cast<std::uint8_t>(i);
  REQUIRE(x.send(id(4), {island_id{2}, id(5)}, 10, text, false));
  x.run_for(5s);
  transport::assembly gateway;
  std::optional<bytes> whole;
  for (const auto& each : x.up) {
    if (each.am_type == network::am::packet)
      whole = gateway.on_fragment(each.source, each.payload, x.now());
  }
  REQUIRE(whole);
  CHECK(transport::decode_segment(network::decode_island_packet(*whole)->body)->payload == text);

  const auto down =
      encode(network::island_packet{island_id{2}, id(4), 10, encode(test::plain(id(5), 10, text))});
  const auto fragments = transport::cut(down, network::frame_payload_max, 1);
  for (const auto& fragment : *fragments)
    x.down(network::am::packet, fragment);
  x.run_for(5s);
  REQUIRE(x.received.size() == 1);
  CHECK(x.received[0].first == id(4));
  CHECK(x.received[0].second.payload == text);

  REQUIRE(x.send(id(4), {own_island, id(2)}, 10, text, true));
  x.run_for(10s);
  REQUIRE(x.received.size() == 2);
  CHECK(x.received[1].first == id(2));
  CHECK(x.received[1].second.payload == text);
  REQUIRE(x.outcomes.size() == 1);
  CHECK(x.outcomes[0].second);
  CHECK(x.longest <= network::frame_payload_max);
}

TEST_CASE("messages inside the island never touch the serial line",
          "[mote][network][RTG-01][NFR-07]") {
  const auto world = settled({.width = 5});
  auto& x = *world;
  for (int from = 2; from <= 5; ++from) {
    for (int to = 2; to <= 5; ++to) {
      REQUIRE(x.send(id(from), {own_island, id(to)}, 10, bytes{1}, true));
      x.run_for(3s);
    }
  }
  x.run_for(30s);
  CHECK(x.received.size() == 16);
  CHECK(x.outcomes.size() == 16);
  CHECK(count_of_packets_up(x) == 0);
  CHECK(x.root().counters().up == 0);
  CHECK(x.root().counters().turned > 0); // those who are no neighbours
}

TEST_CASE("everybody receives once what is sent to all, of this island or another",
          "[mote][network][ADR-05]") {
  const bool from_outside = GENERATE(true, false);
  const auto world = settled({.width = 4, .height = 3, .delivery = 0.95});
  auto& x = *world;
  const auto message = test::plain(id(12), 10, bytes{'a'});
  if (from_outside)
    x.down(network::am::from_gateway,
           encode(network::island_packet{island_id{2}, broadcast_mote, 10, encode(message)}));
  else
    REQUIRE(x.send(id(12), {own_island, broadcast_mote}, 10, bytes{'a'}, false));
  x.run_for(20s);
  std::multiset<mote_id> reached;
  for (const auto& [who, what] : x.received) {
    reached.insert(who);
    CHECK(what.source == mote_address{island_id{from_outside ? 2U : 1U}, id(12)});
  }
  for (int i = 2; i <= 12; ++i)
    CHECK(reached.count(id(i)) == (i < 12 || from_outside ? 1U : 0U));
  CHECK(count_of_packets_up(x) == 0);
}

TEST_CASE("reliable messages survive a lossy line of motes in both directions",
          "[mote][network][MCK-12][IF-07]") {
  int acked = 0;
  int delivered = 0;
  for (std::uint64_t seed = 1; seed <= test::seeds(5); ++seed) {
    const auto world = settled({.width = 5, .delivery = 0.8, .seed = seed});
    auto& x = *world;
    for (std::uint8_t i = 0; i < 20; ++i) {
      REQUIRE(x.send(id(5), {own_island, id(3)}, 10, bytes{i}, true));
      REQUIRE(x.send(id(2), {own_island, id(5)}, 10, bytes{i}, true));
      x.run_for(2s);
    }
    x.run_for(2min);
    REQUIRE(x.outcomes.size() == 40);
    std::set<std::pair<mote_id, bytes>> once;
    for (const auto& [who, what] : x.received)
      CHECK(once.emplace(who, what.payload).second);
    for (const auto& [who, was_acked] : x.outcomes)
      acked += was_acked ? 1 : 0;
    delivered += static_cast<int>(once.size());
  }
  CHECK(acked >= static_cast<int>(40 * test::seeds(5)) - 4);
  CHECK(delivered >= acked);
}

TEST_CASE("a mote that is started again joins again and is distinguished from its life before",
          "[mote][network][DIS-07]") {
  const auto world = settled({.width = 4});
  auto& x = *world;
  x.start(id(3));
  CHECK(x.run_until(
      [&x] {
        return std::ranges::any_of(x.up, [](const auto& each) {
          const auto event = network::decode_sink_event(each.payload);
          const auto* joined = event ? std::get_if<network::mote_joined>(&*event) : nullptr;
          return joined != nullptr && joined->mote == id(3) && joined->incarnation == 1;
        });
      },
      1min));
  x.run_for(30s);
  REQUIRE(x.send(id(4), {own_island, no_mote}, 1, bytes{1}, false));
  x.run_for(5s);
  CHECK(count_of_packets_up(x) == 1);
}

TEST_CASE("motes whose sink has started again join it again", "[mote][network][DIS-05][GW-15]") {
  const auto world = settled({.width = 4});
  auto& x = *world;
  x.start(island_fixture::sink_id);
  CHECK(x.run_until([&x] { return x.root().members() == 3; }, 2min));
}

TEST_CASE("a mote that dies leaves, and those behind it too if there is no other route",
          "[mote][network][DIS-06]") {
  const auto world = settled({.width = 4});
  auto& x = *world;
  x.kill(id(3));
  CHECK(x.run_until([&x] { return x.root().members() == 1; }, 1min));
  x.start(id(3));
  CHECK(x.run_until([&x] { return x.root().members() == 3; }, 3min));
}
