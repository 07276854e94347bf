// What motes and sinks remember over a loss of power, and when they write it.
#include "mote/node.hpp"
#include "mote/sink.hpp"
#include "network/am.hpp"
#include "support/catch.hpp"
#include "support/island_fixture.hpp"
#include "support/pick.hpp"

using namespace rubicon;
using namespace rubicon::mote;
using test::island_fixture;
using test::pick;

namespace {

sink with_two_lines(const nonvolatile& store) {
  registrar_config members;
  members.island = island_id{1};
  network::router_config network;
  network.self = island_fixture::sink_id;
  return {network, members, duty_config{}, random_stream(1), {}, {.lines = 2}, store};
}

} // namespace

TEST_CASE("a mote has counted its start in its flash before it does anything else",
          "[mote][DIS-07][ACT-04]") {
  node_config config;
  config.id = mote_id{2};
  node x(config, nonvolatile{41, 0}, random_stream(1), {});
  CHECK(x.above().ports().node.config.incarnation == 41);
  const auto begun = x.start({});
  REQUIRE(!begun.empty());
  CHECK(std::get<store_nonvolatile>(begun[0]).content == nonvolatile{42, 0});
}

TEST_CASE("a mote cut off at once is another in its next life all the same",
          "[mote][DIS-07][ACT-04]") {
  island_fixture world({.width = 2});
  const mote_id lamp{2};
  for (std::uint32_t life = 0; life < 5; ++life) {
    CHECK(world.at(lamp).above().ports().node.config.incarnation == life);
    CHECK(world.stores[lamp].starts == life + 1);
    world.kill(lamp); // before it has sent anything
    world.start(lamp);
  }
  REQUIRE(world.run_until([&] { return world.joined() == 1; }, 1min));
  std::optional<std::uint32_t> received;
  for (const auto& x : world.up) {
    const auto event = network::decode_sink_event(x.payload);
    if (const auto* joined = event ? std::get_if<network::mote_joined>(&*event) : nullptr)
      received = joined->incarnation;
  }
  CHECK(received == 5U);
}

TEST_CASE("a sink counts its starts, and no term of its gateways comes twice",
          "[mote][GW-14][ACT-04]") {
  auto first = with_two_lines({});
  const auto begun = pick<store_nonvolatile>(first.start({}));
  REQUIRE(begun.size() == 1);
  CHECK(begun[0].content == nonvolatile{1, 1});
  CHECK(first.incarnation() == 0);
  // No answer to the first gateway's questions comes: the second takes over, in the next term.
  nonvolatile store = begun[0].content;
  for (instant now{}; now < instant{5s}; now = first.deadline()) {
    for (const auto& x : pick<store_nonvolatile>(first.on_time(now)))
      store = x.content;
    const auto answer = encode(network::sink_event(network::gateway_answer{3, 0}));
    for (const auto& x :
         pick<store_nonvolatile>(first.on_packet(network::am::sink_event, answer, now, 1)))
      store = x.content;
  }
  CHECK(first.lines().leader() == 1);
  CHECK(store == nonvolatile{1, 2, 1});
  auto second = with_two_lines(store);
  const auto again = pick<store_nonvolatile>(second.start({}));
  REQUIRE(again.size() == 1);
  CHECK(again[0].content == nonvolatile{2, 3, 1});
  CHECK(second.incarnation() == 1);
  CHECK(second.lines().term() == 3);
}
