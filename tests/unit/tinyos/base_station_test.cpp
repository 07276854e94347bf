#include <cstdint>

#include "serial/raw_packet.hpp"
#include "support/catch.hpp"
#include "tinyos/base_station.hpp"

using namespace rubicon;
using namespace rubicon::tinyos;

namespace {

bytes from_line(std::uint16_t to, std::uint8_t am_type, bytes payload) {
  return serial::encode(serial::am_packet{to, 0, 0x22, am_type, std::move(payload)});
}

} // namespace

TEST_CASE("a base station forwards whatever it receives", "[tinyos][GW-17]") {
  base_station x;
  const bytes payload{0, 7, 0, 1};
  const auto packet = x.on_frame({0x1422, mote_id{3}, mote_id{7}, 6, payload});
  REQUIRE(packet);
  // Destination, source and type as on the radio, the group is the low octet of the PAN.
  CHECK(*packet == serial::am_packet{3, 7, 0x22, 6, payload});
  CHECK(serial::encode(*packet) == bytes{0, 0, 3, 0, 7, 4, 0x22, 6, 0, 7, 0, 1});
  CHECK(x.counters().up == 1);
}

TEST_CASE("a base station forwards a frame of another layout as it is", "[tinyos][GW-17]") {
  base_station x;
  const auto packet = x.on_raw_frame(bytes{0x41, 0x88, 7, 1, 0, 0xff, 0xff, 3, 0, 'h', 'i'});
  CHECK(packet == bytes{2, 13, 0x41, 0x88, 7, 1, 0, 0xff, 0xff, 3, 0, 'h', 'i'}); // its FCS counts
  CHECK(serial::decode_raw_packet(packet));
  CHECK(x.counters().up == 1);
  CHECK(x.counters().up_raw == 1);
  CHECK(x.on_raw_frame(bytes(125)).size() == 127);
}

TEST_CASE("a base station has room for 28 octets of payload", "[tinyos][GW-17]") {
  base_station x;
  CHECK(x.on_frame({1, mote_id{3}, mote_id{7}, 6, bytes(28)}));
  CHECK(!x.on_frame({1, mote_id{3}, mote_id{7}, 6, bytes(29)}));
  CHECK(x.counters().up_too_long == 1);
  CHECK(x.on_packet(from_line(7, 6, bytes(28))));
  CHECK(!x.on_packet(from_line(7, 6, bytes(29))));
  CHECK(x.counters().down_malformed == 1);
}

TEST_CASE("what comes over the line goes out one by one", "[tinyos][GW-17]") {
  base_station x;
  const auto first = x.on_packet(from_line(7, 6, {1}));
  REQUIRE(first);
  CHECK(first->destination == mote_id{7});
  CHECK(int{first->am_type} == 6);
  CHECK(first->payload == bytes{1});
  CHECK(!x.on_packet(from_line(0xffff, 0x93, {2})));
  CHECK(x.queued() == 2);
  const auto second = x.on_radio_done(radio_result::sent);
  REQUIRE(second);
  CHECK(second->destination == broadcast_mote);
  CHECK(second->payload == bytes{2});
  CHECK(!x.on_radio_done(radio_result::sent));
  CHECK(x.queued() == 0);
  CHECK(x.counters().down_sent == 2);
  CHECK(!x.on_radio_done(radio_result::sent)); // nothing was there
}

TEST_CASE("a base station tries again while the channel is busy", "[tinyos][GW-17]") {
  base_station x;
  static_cast<void>(x.on_packet(from_line(7, 6, {1})));
  static_cast<void>(x.on_packet(from_line(7, 6, {2})));
  for (int i = 0; i < 50; ++i) {
    const auto again = x.on_radio_done(radio_result::busy);
    REQUIRE(again);
    CHECK(again->payload == bytes{1});
  }
  CHECK(x.counters().down_repeats == 50);
  const auto next = x.on_radio_done(radio_result::off); // else it would spin
  REQUIRE(next);
  CHECK(next->payload == bytes{2});
  CHECK(x.counters().down_lost == 1);
}

TEST_CASE("the queue to the radio holds twelve packets", "[tinyos][GW-17]") {
  base_station x;
  CHECK(x.on_packet(from_line(7, 6, {1})));
  for (int i = 1; i < 12; ++i)
    CHECK(!x.on_packet(from_line(7, 6, {1})));
  CHECK(x.counters().down == 12);
  CHECK(x.counters().down_full == 0);
  CHECK(!x.on_packet(from_line(7, 6, {1})));
  CHECK(x.counters().down_full == 1);
  CHECK(x.queued() == 12);
}

TEST_CASE("what is no active message is counted", "[tinyos][GW-17]") {
  base_station x;
  for (const auto& packet : {bytes{}, bytes{0}, bytes{1, 0, 0}, bytes{0, 0, 3, 0, 7, 9, 0x22, 6}})
    CHECK(!x.on_packet(packet));
  CHECK(x.counters().down_malformed == 4);
  CHECK(x.queued() == 0);
}
