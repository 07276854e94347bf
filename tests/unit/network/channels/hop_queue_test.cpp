#include "network/channels/hop_queue.hpp"

#include "support/catch.hpp"

namespace rubicon::network {

namespace {

using queued_as = hop_queue::outcome;

constexpr mote_id next_mote{2};
constexpr mote_id other_mote{3};

channel_message packet_of(std::size_t size, std::uint16_t channel = 1) {
  return {{mote_id{1}, channel}, data_message{1, bytes(size, 7)}};
}

channel_message end_message_of(std::uint16_t channel) {
  return {{mote_id{1}, channel}, end_message{}};
}

queued_as put(hop_queue& x, channel_message what, departure how = departure::in_turn) {
  return x.add(next_mote, std::move(what), instant(), how);
}

} // namespace

TEST_CASE("a queue holds so many packets, so many octets, and as many control messages again",
          "[network][channels][NET-05]") {
  SECTION("packets") {
    hop_queue x(2, 100);
    CHECK(put(x, packet_of(10)) == queued_as::queued);
    CHECK(x.has_room(90));
    CHECK_FALSE(x.has_room(91));
    CHECK(put(x, packet_of(10)) == queued_as::queued);
    CHECK_FALSE(x.has_room(0));
    CHECK(put(x, packet_of(0)) == queued_as::lost);
    CHECK(put(x, end_message_of(1)) == queued_as::queued);
    CHECK(put(x, end_message_of(2)) == queued_as::queued);
    CHECK(put(x, end_message_of(3)) == queued_as::crowded_out);
  }
  SECTION("octets, of the packet at the radio too") {
    hop_queue x(2, 100);
    CHECK(put(x, packet_of(60)) == queued_as::queued);
    REQUIRE(x.take(instant()));
    CHECK(put(x, packet_of(41)) == queued_as::lost);
    CHECK(put(x, packet_of(40)) == queued_as::queued);
    CHECK(x.on_sent());
    CHECK(x.has_room(60));
  }
}

TEST_CASE("the end of a channel waits once for each neighbour", "[network][channels][NET-04]") {
  hop_queue x(4, 100);
  CHECK(put(x, end_message_of(1)) == queued_as::queued);
  CHECK(put(x, end_message_of(1)) == queued_as::repeated);
  CHECK(put(x, end_message_of(2)) == queued_as::queued);
  CHECK(x.add(other_mote, end_message_of(1), instant(), departure::in_turn) == queued_as::queued);
}

TEST_CASE("the radio has one message at a time, and a repeat goes before all others",
          "[network][channels][NET-05]") {
  hop_queue x(4, 100);
  CHECK_FALSE(x.on_sent());
  put(x, packet_of(1, 1));
  put(x, packet_of(1, 2));
  REQUIRE(x.take(instant()));
  CHECK_FALSE(x.take(instant()));
  CHECK_FALSE(x.deadline());
  auto sent = x.on_sent();
  REQUIRE(sent);
  CHECK(sent->message.channel.number == 1);
  CHECK(sent->rounds == 1);
  x.repeat(*std::move(sent), instant(5ms));
  CHECK(x.deadline() == instant());
  REQUIRE(x.take(instant(5ms)));
  sent = x.on_sent();
  REQUIRE(sent);
  CHECK(sent->message.channel.number == 1);
  CHECK(sent->rounds == 2);
}

TEST_CASE("who holds back sends in slots and at once, but in their first round alone",
          "[network][channels][NRG-03]") {
  const auto how = GENERATE(departure::in_slot, departure::at_once);
  hop_queue x(4, 100);
  x.hold(instant(1s));
  put(x, packet_of(1, 1));
  CHECK(x.deadline() == instant(1s));
  CHECK_FALSE(x.take(instant(1s) - 1ns));
  put(x, packet_of(1, 2), how);
  CHECK(x.deadline() == instant());
  const auto hop = x.take(instant());
  REQUIRE(hop);
  CHECK(hop->in_slot == (how == departure::in_slot));
  auto sent = x.on_sent();
  REQUIRE(sent);
  CHECK(sent->message.channel.number == 2);
  x.repeat(*std::move(sent), instant(1ms));
  CHECK_FALSE(x.take(instant(1s) - 1ns));
  const auto again = x.take(instant(1s));
  REQUIRE(again);
  CHECK_FALSE(again->in_slot);
  CHECK(x.on_sent()->message.channel.number == 2);
}

TEST_CASE("what waits for a channel that is no more is dropped, and of a flood what is for all",
          "[network][channels][NET-07]") {
  hop_queue x(4, 100);
  put(x, packet_of(1, 1));
  put(x, packet_of(1, 2));
  CHECK(x.add(broadcast_mote, end_message_of(2), instant(), departure::in_turn) ==
        queued_as::queued);
  x.drop_flood({mote_id{1}, 2});
  x.drop({mote_id{1}, 1});
  const auto hop = x.take(instant());
  REQUIRE(hop);
  CHECK(hop->next == next_mote);
  CHECK(x.on_sent()->message.channel.number == 2);
  CHECK_FALSE(x.take(instant()));
}

} // namespace rubicon::network
