#include "network/am.hpp"
#include "network/star.hpp"
#include "support/catch.hpp"
#include "support/pick.hpp"

using namespace rubicon;
using namespace rubicon::network;
using test::pick;

namespace {

constexpr island_id kitchen{1};
constexpr mote_id self{7};
constexpr mote_id sink{3};

star joined_star() {
  star x(self);
  x.join(kitchen, sink);
  return x;
}

} // namespace

TEST_CASE("a mote decides by address: own island direct, else by way of the sink",
          "[network][RTG-01][RTG-04][ADR-03][ADR-05][ADR-06][ADR-07]") {
  struct row {
    mote_address destination;
    mote_id next_hop;
    std::uint8_t am_type;
    std::string payload;
  };
  const row rows[] = {
      {{own_island, mote_id{8}}, mote_id{8}, am::local, "000aff"},
      {{kitchen, mote_id{8}}, mote_id{8}, am::local, "000aff"},
      {{own_island, broadcast_mote}, broadcast_mote, am::local, "000aff"},
      {{island_id{2}, mote_id{8}}, sink, am::to_gateway, "000000020008000aff"},
      {{island_id{2}, broadcast_mote}, sink, am::to_gateway, "00000002ffff000aff"},
      {{own_island, no_mote}, sink, am::to_gateway, "00000001fffd000aff"},
      {{island_id{40}, no_mote}, sink, am::to_gateway, "00000028fffd000aff"},
  };
  for (const auto& row : rows) {
    auto x = joined_star();
    const auto frames = pick<transmit>(x.send(row.destination, 10, bytes{0xff}));
    REQUIRE(frames.size() == 1);
    CHECK(frames[0].next_hop == row.next_hop);
    CHECK(frames[0].am_type == row.am_type);
    CHECK(to_hex(frames[0].payload) == row.payload);
  }
}

TEST_CASE("a message to oneself needs no radio", "[network][ADR-06]") {
  auto x = joined_star();
  for (const auto mote : {self, own_mote}) {
    const auto out = x.send({own_island, mote}, 10, bytes{1});
    REQUIRE(pick<arrived>(out).size() == 1);
    CHECK(pick<arrived>(out)[0].source_island == kitchen);
    CHECK(pick<transmit>(out).empty());
  }
}

TEST_CASE("frames bring segments with the island they come from", "[network][A-51]") {
  auto x = joined_star();
  const auto local = pick<arrived>(x.on_frame(am::local, *from_hex("000aff")));
  REQUIRE(local.size() == 1);
  CHECK(local[0].source_island == kitchen);
  CHECK(local[0].channel == 10);
  CHECK(to_hex(local[0].segment) == "ff");
  const auto foreign = pick<arrived>(x.on_frame(am::from_gateway, *from_hex("000000020007000aff")));
  REQUIRE(foreign.size() == 1);
  CHECK(foreign[0].source_island == island_id{2});
}

TEST_CASE("frames that are broken or for another mote are counted and dropped", "[network]") {
  auto x = joined_star();
  CHECK(x.on_frame(am::local, bytes{0}).empty());
  CHECK(x.on_frame(am::from_gateway, bytes{0, 0}).empty());
  CHECK(x.counters().malformed == 2);
  CHECK(x.on_frame(am::from_gateway, *from_hex("000000020008000aff")).empty());
  CHECK(x.counters().misdirected == 1);
  CHECK(star::owns(am::local));
  CHECK_FALSE(star::owns(am::sink_event));
}

TEST_CASE("nothing is sent before joining or after leaving", "[network][MCK-16]") {
  star x(self);
  CHECK(x.send({own_island, mote_id{8}}, 10, {}).empty());
  x.join(kitchen, sink);
  CHECK(x.address() == mote_address{kitchen, self});
  x.leave();
  CHECK(x.send({own_island, mote_id{8}}, 10, {}).empty());
  CHECK(x.counters().before_join == 2);
}
