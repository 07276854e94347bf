#include "mote/sink.hpp"
#include "network/am.hpp"
#include "network/island_packet.hpp"
#include "support/catch.hpp"
#include "support/pick.hpp"

using namespace rubicon;
using namespace rubicon::mote;
using test::pick;

namespace {

sink make() {
  registrar_config config;
  config.island = island_id{1};
  return {mote_id{1}, config};
}

} // namespace

TEST_CASE("a sink passes island packets up and down as they are", "[mote][RTG-02]") {
  auto x = make();
  const auto packet = encode(network::island_packet{island_id{2}, mote_id{5}, 10, bytes{'h', 'i'}});
  const auto up = pick<to_gateway>(x.on_frame(mote_id{7}, network::am::to_gateway, packet, {}));
  REQUIRE(up.size() == 1);
  CHECK(up[0].source == mote_id{7});
  CHECK(up[0].am_type == network::am::to_gateway);
  CHECK(up[0].payload == packet);
  const auto down = pick<network::transmit>(x.on_packet(network::am::from_gateway, packet, {}));
  REQUIRE(down.size() == 1);
  CHECK(down[0].next_hop == mote_id{5});
  CHECK(down[0].payload == packet);
  CHECK(x.counters().up == 1);
  CHECK(x.counters().down == 1);
}

TEST_CASE("a sink drops and counts what it cannot read", "[mote]") {
  auto x = make();
  CHECK(x.on_packet(network::am::from_gateway, bytes{0}, {}).empty());
  CHECK(x.on_packet(network::am::sink_event, bytes{9}, {}).empty());
  CHECK(x.on_packet(network::am::sink_event, encode(network::sink_event(network::roster{})), {})
            .empty());
  CHECK(x.on_packet(0x77, {}, {}).empty());
  CHECK(x.counters().malformed == 3);
  CHECK(x.counters().unknown_type == 1);
}

TEST_CASE("a sink answers its gateway's question about a mote", "[mote][GW-15]") {
  auto x = make();
  const auto out = pick<to_gateway>(x.on_packet(
      network::am::sink_event, encode(network::sink_event(network::describe{mote_id{7}})), {}));
  REQUIRE(out.size() == 1);
  CHECK(out[0].source == mote_id{1});
  CHECK(to_hex(out[0].payload) == "02000702");
}
