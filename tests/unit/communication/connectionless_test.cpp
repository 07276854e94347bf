// Connectionless messages between motes and PCs, wherever they are (PAR-03).
#include <algorithm>

#include "support/catch.hpp"
#include "support/placements_fixture.hpp"

using namespace rubicon;
using test::placement;
using test::placements_fixture;
using test::recorder;
using test::user_am_type;

namespace {

communication::island_octet octet(island_id x) {
  return static_cast<communication::island_octet>(x.value);
}

/// The same code whatever the placement (PAR-05).
communication::status send(placements_fixture& world, recorder& sender, const placement& x,
                           bytes octets, bool reliable) {
  return world.act(x.from, [&] {
    return sender.layer->send(octet(x.to.island), x.to.mote.value, octets, reliable, user_am_type);
  });
}

void connect(placements_fixture& world, const placement& x, recorder& sender, recorder& receiver) {
  REQUIRE(world.settle());
  attach(world, x, sender, receiver);
  REQUIRE(receiver.layer->provide(user_am_type) == communication::SUCCESS);
}

} // namespace

TEST_CASE("messages arrive with their source, reliable ones acknowledged, in all placements",
          "[communication][PAR-03][PAR-05][GEN-09][MCK-09][MCK-10][MCK-11][ADR-07]") {
  const auto& x =
      test::placements[GENERATE(range(0U, test::placements_max, test::placements_step))];
  recorder sender;
  recorder receiver;
  placements_fixture world;
  CAPTURE(x.name);
  connect(world, x, sender, receiver);

  bytes longest(256);
  for (std::size_t i = 0; i < longest.size(); ++i)
    longest[i] = static_cast<std::uint8_t>(i);
  REQUIRE(send(world, sender, x, longest, false) == communication::SUCCESS);
  world.run_for(5s);
  REQUIRE(receiver.messages.size() == 1);
  CHECK(receiver.messages[0].source == x.from);
  CHECK(receiver.messages[0].octets == longest);
  CHECK(sender.acks.empty());

  for (std::uint8_t i = 0; i < 8; ++i)
    REQUIRE(send(world, sender, x, {i}, true) == communication::SUCCESS);
  world.run_for(20s);
  REQUIRE(receiver.messages.size() == 9);
  for (std::uint8_t i = 0; i < 8; ++i) {
    CHECK(receiver.messages[1U + i].source == x.from);
    CHECK(receiver.messages[1U + i].octets == bytes{i});
  }
  CHECK(sender.acks == std::vector<bool>(8, true));
  CHECK(sender.acks_of.size() == 8);
  CHECK(sender.messages.empty());
}

TEST_CASE("what is acknowledged has arrived once and in order, over lossy routes in all placements",
          "[communication][PAR-03][MCK-12][MCK-18][AM-04]") {
  const auto& x =
      test::placements[GENERATE(range(0U, test::placements_max, test::placements_step))];
  recorder sender;
  recorder receiver;
  placements_fixture world({.frame_delivery = 0.85, .message_delivery = 0.75, .seed = 7});
  CAPTURE(x.name);
  connect(world, x, sender, receiver);

  for (std::uint8_t i = 0; i < 40; ++i) {
    REQUIRE(send(world, sender, x, {i}, true) == communication::SUCCESS);
    world.run_until([&] { return sender.acks.size() == i + 1U; }, 20s);
  }
  REQUIRE(sender.acks.size() == 40); // an end for each
  std::vector<std::uint8_t> arrived;
  for (const auto& each : receiver.messages) {
    REQUIRE(each.octets.size() == 1);
    CHECK(each.source == x.from);
    arrived.push_back(each.octets[0]);
  }
  CHECK(std::ranges::is_sorted(arrived));
  CHECK(std::ranges::adjacent_find(arrived) == arrived.end());
  for (std::uint8_t i = 0; i < 40; ++i)
    CHECK((!sender.acks[i] || std::ranges::binary_search(arrived, i)));
  CHECK(std::ranges::count(sender.acks, true) >= 36);
}

TEST_CASE("a reliable message without a receiver fails after its attempts, in all placements",
          "[communication][MCK-10][MCK-12]") {
  const auto& x =
      test::placements[GENERATE(range(0U, test::placements_max, test::placements_step))];
  recorder sender;
  placements_fixture world;
  CAPTURE(x.name);
  REQUIRE(world.settle());
  world.attach(x.from, sender, x.beside);
  world.kill(x.to);
  REQUIRE(send(world, sender, x, {1}, true) == communication::SUCCESS);
  world.run_for(15s);
  CHECK(sender.acks.empty());
  world.run_for(1s);
  CHECK(sender.acks == std::vector{false});
}

TEST_CASE("a receiver without room throttles senders, in all placements",
          "[communication][MCK-18]") {
  const auto& x =
      test::placements[GENERATE(range(0U, test::placements_max, test::placements_step))];
  recorder sender;
  recorder receiver;
  placements_fixture world;
  CAPTURE(x.name);
  connect(world, x, sender, receiver);
  receiver.layer->hold(user_am_type);
  for (std::uint8_t i = 0; i < 5; ++i)
    REQUIRE(send(world, sender, x, {i}, true) == communication::SUCCESS);
  world.run_for(1min); // beyond all attempts
  CHECK(receiver.messages.empty());
  CHECK(sender.acks.empty());
  CHECK(world.layer_of(x.to).ports().messages.core().counters().throttled > 50);
  receiver.layer->release(user_am_type);
  world.run_for(10s);
  CHECK(receiver.messages.size() == 5);
  CHECK(sender.acks == std::vector<bool>(5, true));
}

TEST_CASE("a PC, or a mote of another island, reaches all motes of an island with one message",
          "[communication][ADR-05]") {
  const auto from =
      GENERATE(mote_address{island_id{20}, no_mote}, mote_address{island_id{2}, mote_id{3}});
  CAPTURE(to_string(from));
  std::array<recorder, 6> motes;
  recorder sender;
  placements_fixture world;
  REQUIRE(world.settle());
  world.attach(from, sender);
  for (std::uint16_t i = 0; i < 6; ++i) {
    world.attach({island_id{1}, mote_id(static_cast<std::uint16_t>(i + 2))}, motes[i]);
    REQUIRE(motes[i].layer->provide(user_am_type) == communication::SUCCESS);
  }
  CHECK(world.act(from, [&] {
    return sender.layer->send(1, broadcast_mote.value, bytes{'a'}, true, user_am_type);
  }) == communication::FAIL); // none could acknowledge for all
  REQUIRE(world.act(from, [&] {
    return sender.layer->send(1, broadcast_mote.value, bytes{'a'}, false, user_am_type);
  }) == communication::SUCCESS);
  world.run_for(10s);
  for (const auto& each : motes) {
    REQUIRE(each.messages.size() == 1);
    CHECK(each.messages[0].source == from);
  }
}
