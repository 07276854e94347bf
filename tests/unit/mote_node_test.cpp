#include "mote/node.hpp"
#include "network/am.hpp"
#include "network/island_packet.hpp"
#include "support/catch.hpp"
#include "support/pick.hpp"

using namespace rubicon;
using namespace rubicon::mote;
using test::pick;

namespace {

constexpr mote_id self{7};
constexpr mote_id the_sink{1};
constexpr island_id island{1};

node make() {
  node_config config;
  config.id = self;
  config.type = 301;
  config.transducers = {{quantity::light, constant_model{100}, 0, 1}};
  config.actuators = {{"fan", actuator_kind::relay, 0}, {"lamp", actuator_kind::dimmer, 9}};
  return {config, 0, random_stream(1)};
}

void join(node& x, instant& now) {
  static_cast<void>(x.start(now));
  now = *x.deadline();
  const auto frames = pick<network::transmit>(x.on_time(now));
  REQUIRE(frames.size() == 1);
  CHECK(frames[0].am_type == network::am::component_management);
  const auto request = std::get<join_request>(*decode_management(frames[0].payload));
  const auto in = x.on_frame(the_sink, network::am::component_management,
                             encode(join_reply{request.sequence, island, self, 0}), now);
  REQUIRE(pick<membership>(in).size() == 1);
  CHECK(pick<membership>(in)[0].joined);
  REQUIRE(x.joined());
}

} // namespace

TEST_CASE("before it has joined a mote refuses to send", "[mote][MCK-16]") {
  auto x = make();
  CHECK_FALSE(x.send(1, {own_island, mote_id{8}}, 10, {}, false, {}).has_value());
}

TEST_CASE("a joined mote sends readings to its gateway by way of the sink", "[mote][RTG-03]") {
  auto x = make();
  instant now{};
  join(x, now);
  const auto out = x.send(1, {own_island, no_mote}, 1, bytes{0, 5}, false, now);
  REQUIRE(out.has_value());
  const auto frames = pick<network::transmit>(*out);
  REQUIRE(frames.size() == 1);
  CHECK(frames[0].next_hop == the_sink);
  CHECK(frames[0].am_type == network::am::to_gateway);
  const auto packet = network::decode_island_packet(frames[0].payload);
  REQUIRE(packet);
  CHECK(packet->island == island);
  CHECK(packet->mote == no_mote);
  CHECK(packet->channel == 1);
}

TEST_CASE("a message from another island is passed up and acknowledged back there",
          "[mote][MCK-11][MCK-12]") {
  auto x = make();
  instant now{};
  join(x, now);
  const auto segment = encode(transport::segment{mote_id{5}, 99, 10, true, false, bytes{'h'}});
  const auto out = x.on_frame(the_sink, network::am::from_gateway,
                              encode(network::island_packet{island_id{2}, self, 10, segment}), now);
  REQUIRE(pick<transport::received>(out).size() == 1);
  CHECK(pick<transport::received>(out)[0].source == mote_address{island_id{2}, mote_id{5}});
  const auto frames = pick<network::transmit>(out);
  REQUIRE(frames.size() == 1);
  const auto back = network::decode_island_packet(frames[0].payload);
  REQUIRE(back);
  CHECK(back->island == island_id{2});
  CHECK(back->mote == mote_id{5});
  CHECK(transport::decode_segment(back->body)->acknowledgement);
}

TEST_CASE("a mote reads only the transducers and moves only the actuators it has",
          "[mote][STR-09][DIS-02]") {
  auto x = make();
  CHECK(x.read(quantity::light, {}) == std::int16_t{100});
  CHECK_FALSE(x.read(quantity::sound, {}).has_value());
  CHECK(x.actuator_state("lamp") == std::uint8_t{9});
  CHECK(x.actuate("fan", 1));
  CHECK(x.actuator_state("fan") == std::uint8_t{1});
  CHECK_FALSE(x.actuate("fan", 2)); // a relay is on or off
  CHECK(x.actuate("lamp", 200));
  CHECK_FALSE(x.actuate("door", 1));
  CHECK_FALSE(x.actuator_state("door").has_value());
}

TEST_CASE("a leaving mote says goodbye and fails what it was waiting for", "[mote][DIS-06]") {
  auto x = make();
  instant now{};
  join(x, now);
  REQUIRE(x.send(5, {own_island, no_mote}, 1, {}, true, now).has_value());
  const auto out = x.leave();
  REQUIRE(pick<transport::outcome>(out).size() == 1);
  CHECK_FALSE(pick<transport::outcome>(out)[0].acked);
  CHECK(pick<network::transmit>(out).size() == 1);
  CHECK_FALSE(x.joined());
  CHECK_FALSE(x.deadline().has_value());
}

TEST_CASE("frames nobody owns or nobody can read are counted and dropped", "[mote][AM-01]") {
  auto x = make();
  instant now{};
  CHECK(x.on_frame(mote_id{8}, network::am::local, bytes{0, 1}, now).empty()); // not joined
  join(x, now);
  CHECK(x.on_frame(mote_id{8}, 0x77, {}, now).empty());
  CHECK(x.counters().unknown_type == 2);
  CHECK(x.on_frame(mote_id{8}, network::am::component_management, bytes{0x77}, now).empty());
  CHECK(x.counters().malformed == 1);
}
