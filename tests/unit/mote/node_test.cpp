#include <algorithm>
#include <array>
#include <string>
#include <tuple>

#include "communication/interface.hpp"
#include "mote/node.hpp"
#include "network/am.hpp"
#include "network/island_packet.hpp"
#include "support/catch.hpp"
#include "support/island_fixture.hpp"
#include "support/mote_ids.hpp"
#include "support/pick.hpp"
#include "support/segments.hpp"

using namespace rubicon;
using namespace rubicon::communication;
using namespace rubicon::device;
using namespace rubicon::mote;
using test::island_fixture;
using test::pick;
using test::the_island;

namespace {

constexpr mote_id self{2};
constexpr mote_id neighbour{3};

/// A sink, a mote and its neighbour, each in reach of the others, who have joined.
std::unique_ptr<island_fixture> joined_island() {
  auto world = std::make_unique<island_fixture>(
      test::island_fixture_config{.width = 2, .height = 2, .island = the_island});
  auto& x = *world;
  REQUIRE(x.run_until([&x] { return x.joined() == 3; }, 1min));
  x.run_for(30s); // neighbours know each other
  x.up.clear();
  x.received.clear();
  return world;
}

node lonely() {
  node_config config;
  config.id = self;
  config.type = 301;
  config.transducers = {{quantity::light, constant_model{100}, 0, 1}};
  config.actuators = {{"fan", actuator_kind::relay, 0}, {"lamp", actuator_kind::dimmer, 9}};
  return {config, nonvolatile{}, random_stream(1), {}};
}

/// What has come up to the gateway, whole.
std::vector<network::island_packet> packets_up(const island_fixture& x) {
  std::vector<network::island_packet> found;
  for (const auto& each : x.up) {
    if (each.am_type == network::am::to_gateway)
      found.push_back(*network::decode_island_packet(each.payload));
  }
  return found;
}

void send_down(island_fixture& x, island_id from, const transport::segment& segment) {
  x.down(network::am::from_gateway,
         encode(network::island_packet{from, self, segment.am_type, encode(segment)}));
}

/// A program that records what its mote's transducers and actuators report.
struct carried_by_mote final : communication_events {
  void transducersRead(std::span<const std::int16_t> all, std::uint32_t) override {
    counts.assign(all.begin(), all.end());
  }
  void actuatorChanged(std::string_view name, std::uint8_t state, bool obeyed) override {
    changes.emplace_back(name, state, obeyed);
  }

  std::vector<std::int16_t> counts;
  std::vector<std::tuple<std::string, unsigned, bool>> changes;
};

} // namespace

TEST_CASE("before it has joined a mote refuses to send", "[mote][MCK-16]") {
  auto x = lonely();
  communication_events no_program;
  auto program = x.attach(no_program);
  CHECK_FALSE(program.send_numbered({own_island, neighbour}, bytes{1}, false, 10).has_value());
  CHECK(program.send(255, neighbour.value, bytes{1}, true, 10) == FAIL);
  CHECK(x.above().counters().before_join == 2);
  CHECK(x.settle({}).empty());
}

TEST_CASE("a mote without a route to a sink goes on looking for one and asks none",
          "[mote][DIS-08][NET-11]") {
  auto x = lonely();
  const auto begun = x.start({});
  REQUIRE(begun.size() == 1);
  CHECK(std::get<store_nonvolatile>(begun[0]).content.starts == 1);
  int beacons = 0;
  for (instant now{}; now < instant{10min}; now = x.deadline()) {
    for (const auto& frame : pick<network::frame_out>(x.on_time(now))) {
      CHECK(frame.am_type == network::am::beacon);
      ++beacons;
      CHECK(x.on_sent(frame.token, false, 1, now).empty());
    }
  }
  CHECK(beacons > 30);
  CHECK_FALSE(x.member().joined());
}

TEST_CASE("a mote joins the island whose sink it receives and reports so",
          "[mote][DIS-08][MCK-14]") {
  const auto world = joined_island();
  const auto& x = *world;
  REQUIRE(x.memberships.size() == 3);
  for (const auto& [who, what] : x.memberships) {
    CHECK(what.joined);
    CHECK(what.island == the_island);
  }
}

TEST_CASE("a joined mote sends readings to its gateway through the sink", "[mote][RTG-03]") {
  const auto world = joined_island();
  auto& x = *world;
  REQUIRE(x.send(self, {own_island, no_mote}, 1, bytes{0, 5}, false));
  x.run_for(1s);
  const auto packets = packets_up(x);
  REQUIRE(packets.size() == 1);
  CHECK(packets[0].island == the_island);
  CHECK(packets[0].mote == no_mote);
  CHECK(packets[0].channel == 1);
  CHECK(transport::decode_segment(packets[0].body)->payload == bytes{0, 5});
  CHECK(x.up[0].source == self);
}

TEST_CASE("a mote decides by the address: own island, else its sink", "[mote][RTG-04][ADR-03]") {
  const auto to = GENERATE(mote_address{island_id{2}, neighbour}, mote_address{own_island, no_mote},
                           mote_address{the_island, no_mote}, mote_address{own_island, neighbour},
                           mote_address{the_island, neighbour}, mote_address{own_island, own_mote},
                           mote_address{the_island, self});
  const auto world = joined_island();
  auto& x = *world;
  REQUIRE(x.send(self, to, 10, bytes{1}, false));
  x.run_for(1s);
  const bool is_here = (to.island == own_island || to.island == the_island) && to.mote != no_mote;
  CHECK(packets_up(x).size() == (is_here ? 0 : 1));
  REQUIRE(x.received.size() == (is_here ? 1 : 0));
  if (is_here)
    CHECK(x.received[0].first == (to.mote == neighbour ? neighbour : self));
}

TEST_CASE("what a mote sends to itself touches no radio", "[mote][ADR-06]") {
  const auto world = joined_island();
  auto& x = *world;
  const bool reliable = GENERATE(true, false);
  for (const auto to : {own_mote, self}) {
    x.received.clear();
    x.outcomes.clear();
    const auto frames = x.frames;
    REQUIRE(x.send(self, {own_island, to}, 10, bytes{1}, reliable));
    CHECK(x.frames == frames);
    REQUIRE(x.received.size() == 1);
    CHECK(x.received[0].second.source == mote_address{the_island, self});
    CHECK(x.outcomes == std::vector(reliable ? 1 : 0, std::pair(self, true)));
  }
}

TEST_CASE("a message from another island is passed up and acknowledged back there",
          "[mote][MCK-11][MCK-12]") {
  const auto world = joined_island();
  auto& x = *world;
  constexpr island_id other{2};
  send_down(x, other, test::hello(mote_id{5}, 98, 10));
  x.run_for(1s);
  x.up.clear();
  send_down(x, other, test::reliable(mote_id{5}, 99, 10, bytes{'h'}));
  x.run_for(1s);
  REQUIRE(x.received.size() == 1);
  CHECK(x.received[0].first == self);
  CHECK(x.received[0].second.source == mote_address{other, mote_id{5}});
  const auto back = packets_up(x);
  REQUIRE(back.size() == 1);
  CHECK(back[0].island == other);
  CHECK(back[0].mote == mote_id{5});
  CHECK(transport::decode_segment(back[0].body)->what == transport::segment::kind::acknowledgement);
}

TEST_CASE("a mote reads only the transducers and moves only the actuators it has",
          "[mote][STR-09][DIS-02]") {
  auto x = lonely();
  CHECK(x.read(quantity::light, {}) == std::int16_t{100});
  CHECK_FALSE(x.read(quantity::sound, {}).has_value());
  CHECK(x.devices().state("lamp", {}) == std::uint8_t{9});
  CHECK_FALSE(x.devices().state("door", {}).has_value());

  carried_by_mote program;
  auto commands = x.attach(program);
  CHECK(commands.read_transducers(std::array{quantity::light, quantity::light}) == SUCCESS);
  CHECK(commands.read_transducers(std::array{quantity::sound}) == FAIL);
  for (const auto& [name, state] :
       {std::pair{"fan", 1}, std::pair{"fan", 2}, std::pair{"lamp", 200}, std::pair{"door", 1}})
    CHECK(commands.set_actuator(name, static_cast<std::uint8_t>(state)) == SUCCESS);
  const auto todo = x.settle({});
  CHECK(program.counts == std::vector<std::int16_t>{100, 100});
  using change = std::tuple<std::string, unsigned, bool>;
  CHECK(program.changes == std::vector<change>{{"fan", 1U, true},
                                               {"fan", 1U, false}, // a relay is on or off
                                               {"lamp", 200U, true},
                                               {"door", 0U, false}});
  const auto arrived = std::ranges::count_if(
      todo, [](const auto& y) { return std::holds_alternative<actuator_arrived>(y); });
  CHECK(arrived == 2);
}

TEST_CASE("what a named program does and receives is seen by who observes its mote", "[mote]") {
  auto x = lonely();
  std::vector<std::string> seen;
  x.observe([&seen](const program_note& y) {
    const auto what = static_cast<int>(y.what);
    seen.push_back(std::string(y.program) + ' ' + std::to_string(what) + ' ' +
                   std::to_string(y.number) + ' ' + std::string(y.actuator));
  });
  carried_by_mote named;
  carried_by_mote nameless;
  auto commands = x.attach(named, "a");
  static_cast<void>(x.attach(nameless).set_actuator("lamp", 1));
  static_cast<void>(commands.send_numbered({own_island, no_mote}, bytes{1}, true, 9)); // not joined
  static_cast<void>(commands.set_actuator("fan", 1));
  static_cast<void>(x.settle({}));
  CHECK(seen == std::vector<std::string>{"a 0 0 ", "a 1 0 ", "a 3 0 fan"});
}

TEST_CASE("a leaving mote says goodbye and fails what it was waiting for", "[mote][DIS-06]") {
  const auto world = joined_island();
  auto& x = *world;
  REQUIRE(x.send(self, {own_island, no_mote}, 1, {}, true));
  x.run_for(1s);
  x.up.clear();
  x.perform(self, x.at(self).leave(x.own_time(self)));
  REQUIRE(x.outcomes.size() == 1);
  CHECK(x.outcomes[0] == std::pair(self, false));
  CHECK_FALSE(x.at(self).member().joined());
  x.run_for(1min);
  REQUIRE(!x.up.empty());
  CHECK(*network::decode_sink_event(x.up[0].payload) ==
        network::sink_event(network::mote_left{self, network::leave_cause::notice}));
  CHECK_FALSE(x.at(self).member().joined()); // and it stays away
  CHECK(x.outcomes.size() == 1);
}

TEST_CASE("frames of an unknown type or form are counted and dropped", "[mote][AM-01]") {
  const auto world = joined_island();
  auto& x = *world;
  auto& here = x.at(self);
  const auto hear = [&](mote_id from, std::uint8_t am_type, const bytes& octets) {
    const auto t = x.own_time(self);
    CHECK(here.on_frame(from, am_type, octets, t, t).empty());
  };
  hear(neighbour, 0x77, {});
  CHECK(here.packets().router().counters().unknown_type == 1);
  hear(neighbour, network::am::local, {});
  hear(neighbour, network::am::local, bytes{0x77});
  CHECK(here.packets().counters().malformed == 2);
  hear(neighbour, network::am::local, bytes{network::am::component_management, 0x77});
  CHECK(here.counters().malformed == 1);
  hear(neighbour, network::am::beacon, bytes{1});
  CHECK(here.packets().router().counters().malformed == 1);
}

TEST_CASE("a mote takes no packet that is for another, and none before it has joined",
          "[mote][RTG-06]") {
  const auto frame_for = [](mote_id to) {
    const auto octets =
        encode(network::island_packet{the_island, to, 10, encode(test::plain(neighbour, 10, {}))});
    bytes frame{network::am::packet, 0}; // the only fragment
    frame.insert(frame.end(), octets.begin(), octets.end());
    return network::frame_out{0, self, network::am::local, frame, {}};
  };
  const auto world = joined_island();
  world->hear(self, neighbour, frame_for(mote_id{9}));
  CHECK(world->at(self).counters().misdirected == 1);
  CHECK(world->received.empty());
  world->hear(self, neighbour, frame_for(self));
  CHECK(world->at(self).counters().misdirected == 1);
  CHECK(world->received.size() == 1);

  auto apart = lonely();
  CHECK(apart.on_frame(neighbour, network::am::local, frame_for(self).payload, {}, {}).empty());
  CHECK(apart.counters().misdirected == 1);
  CHECK(apart.above().ports().messages.core().counters().received == 0);
}
