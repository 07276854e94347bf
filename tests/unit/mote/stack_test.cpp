#include "mote/join/island_member.hpp"
#include "mote/stack/channel_pacer.hpp"
#include "mote/stack/mote_devices.hpp"
#include "mote/stack/slot_client.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::mote;

namespace {

constexpr stream::channel_handle first{1};
constexpr stream::channel_handle second{2};

/// What leaves, by its first octet; turns come each second.
std::vector<int> sent_at(channel_pacer& x, instant now, bool has_turns = true) {
  std::vector<int> sent;
  x.send_due(
      now, [&](stream::channel_handle, bytes octets) { sent.push_back(octets.at(0)); },
      [&](stream::channel_handle) { return has_turns ? std::optional(now + 1s) : std::nullopt; });
  return sent;
}

} // namespace

TEST_CASE("a paced channel sends one packet at each turn, two if more than two wait",
          "[mote][STR-03]") {
  channel_pacer x;
  const instant turn{1s};
  CHECK_FALSE(x.deadline());
  for (std::uint8_t i = 0; i < channel_pacer::packets_max; ++i)
    CHECK_FALSE(x.push(first, turn, bytes{i}, {}));
  CHECK(x.push(first, turn, bytes{4}, {})); // the oldest is dropped
  CHECK_FALSE(x.push(second, turn + 500ms, bytes{9}, {}));
  CHECK(x.deadline() == turn);
  CHECK(sent_at(x, instant{999ms}).empty());
  CHECK(sent_at(x, turn) == std::vector{1, 2});
  CHECK(x.deadline() == turn + 500ms);
  CHECK(sent_at(x, turn + 500ms) == std::vector{9});
  CHECK(sent_at(x, turn + 1s) == std::vector{3});
  CHECK(sent_at(x, turn + 2s) == std::vector{4});
  CHECK_FALSE(x.deadline());
}

TEST_CASE("a paced channel that has lost its schedule sends all that waits", "[mote]") {
  channel_pacer x;
  const instant turn{1s};
  for (std::uint8_t i = 0; i < 3; ++i)
    CHECK_FALSE(x.push(first, turn, bytes{i}, {}));
  CHECK(sent_at(x, turn, false) == std::vector{0, 1, 2});
  CHECK_FALSE(x.deadline());
}

TEST_CASE("a slot is requested when all channels of vectors are open, or after ten seconds",
          "[mote][SYN-16]") {
  slot_client x;
  random_stream rng(1);
  const instant begin{1min};
  x.set_demand(2, false, rng, begin);
  CHECK_FALSE(x.deadline());
  const bool all_open = GENERATE(true, false);
  const auto now = all_open ? begin + 1s : begin + 10s;
  x.set_demand(3, all_open, rng, now);
  REQUIRE(x.deadline());
  const auto due = *x.deadline();
  CHECK(due <= now + 500ms);
  CHECK_FALSE(x.take_notice({}, rng, due - 1ns).has_value());
  const auto notice = x.take_notice(100ms, rng, due);
  REQUIRE(notice);
  CHECK(notice->units == 3);
  CHECK(x.deadline() == due + 2100ms); // once more if the grant is lost
  x.on_grant({.units = 3}, rng, due + 1s);
  CHECK(*x.deadline() >= due + 46s);
  x.on_lost();
  CHECK_FALSE(x.deadline());
  CHECK(x.granted().units == 0);
}

TEST_CASE("packets of vectors share the slot of their tick one after the other", "[mote][SYN-16]") {
  slot_client x;
  const instant now{1s};
  CHECK_FALSE(x.take(10ms, 2ms, now)); // no slot
  x.begin_tick(30ms);
  CHECK(x.take(10ms, 2ms, now) == now);
  CHECK(x.take(10ms, 2ms, now) == now + 10ms);
  CHECK(x.take(12ms, 2ms, now) == now + 20ms); // what follows a packet may lie behind the slot
  CHECK_FALSE(x.take(10ms, 2ms, now));
  x.delay(now + 10ms, communication::channel_packet{first, bytes{7}, true});
  CHECK(x.deadline() == now + 10ms);
  CHECK_FALSE(x.next(now + 9ms).has_value());
  const auto next = x.next(now + 10ms);
  REQUIRE(next);
  CHECK(std::get<communication::channel_packet>(*next).octets == bytes{7});
  CHECK_FALSE(x.deadline());
}

TEST_CASE("a member reports a weak signal once, and again when it is strong", "[mote][IF-13]") {
  island_member x;
  const instant now;
  CHECK_FALSE(x.on_signal(-88, now).has_value());
  CHECK(x.on_signal(-89, now).has_value()); // not joined: nothing to send, but a change
  CHECK_FALSE(x.on_signal(-85, now).has_value());
  CHECK(x.on_signal(-84, now).has_value());
}

TEST_CASE("a member waits for a route, then for its time to start", "[mote]") {
  island_member x;
  const instant now{5s};
  x.prepare({});
  CHECK(x.waits_for_route());
  x.start_at(now);
  CHECK_FALSE(x.waits_for_route());
  CHECK(x.deadline() == now);
  CHECK_FALSE(x.takes_start(now - 1ns));
  CHECK(x.takes_start(now));
  CHECK_FALSE(x.takes_start(now));
  x.on_joined({island_id{3}, mote_id{1}, {island_id{4}}});
  CHECK(x.island() == island_id{3});
  CHECK(x.gateways() == std::vector{gateway_of(island_id{3}), gateway_of(island_id{4})});
}
