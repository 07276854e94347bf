// How synaptic channels come about, or do not.
#include "support/catch.hpp"
#include "support/pick.hpp"
#include "unit/synaptic/fixture.hpp"

using namespace rubicon;
using namespace rubicon::synaptic;
using test::synaptic_fixture;
using test::value_of;

TEST_CASE("bad arguments and a full table are refused", "[synaptic][SYN-01][SYN-03]") {
  synaptic_fixture x(9);
  const auto self = x.address(0);
  const auto try_out = [&](mote_address to, std::size_t size) {
    return x.at(0).create_out(self, to, size, {}, x.now).refused;
  };
  const auto try_in = [&](mote_address from, std::size_t size) {
    return x.at(0).create_in(self, from, size, {}, x.now).refused;
  };
  CHECK(try_out({island_id{1}, broadcast_mote}, 1) == failure::bad_argument);
  CHECK(try_in({island_id{1}, broadcast_mote}, 1) == failure::bad_argument);
  CHECK(try_out(x.address(1), 0) == failure::bad_argument);
  CHECK(try_in(x.address(1), 0) == failure::bad_argument);
  CHECK(try_out(x.address(1), 11) == failure::bad_argument);
  CHECK(try_out(x.address(1), 256 + 1) == failure::bad_argument);
  CHECK(x.at(0).open_channels() == 0);
  for (std::size_t i = 1; i <= 2; ++i) {
    CHECK_FALSE(try_out(x.address(i), 10));
    CHECK_FALSE(try_in(x.address(i), 10));
  }
  CHECK(try_out(x.address(5), 1) == failure::no_room);
  CHECK(try_in(x.address(5), 1) == failure::no_room);
  CHECK_FALSE(x.at(0).dispose(descriptor{1}).refused);
  CHECK_FALSE(try_out(x.address(5), 1));
}

TEST_CASE("short addresses mean the own island or the one in the parameters",
          "[synaptic][SYN-13]") {
  channels x({.channels_max = 4});
  const mote_address self{island_id{3}, mote_id{7}};
  const auto destination = [&](mote_address to, parameters requested) {
    const auto todo = x.create_out(self, to, 2, requested, {}).todo;
    const auto asked = test::pick<connect_channel>(todo);
    return asked.empty() ? mote_address{} : asked[0].destination;
  };
  CHECK(destination({own_island, mote_id{1}}, {}) == mote_address{island_id{3}, mote_id{1}});
  CHECK(destination({own_island, mote_id{1}}, {.island = island_id{9}}) ==
        mote_address{island_id{9}, mote_id{1}});
  CHECK(destination({island_id{4}, mote_id{1}}, {.island = island_id{9}}) ==
        mote_address{island_id{4}, mote_id{1}});
  CHECK(destination({own_island, own_mote}, {}) == mote_address{}); // ourselves: no channel
}

TEST_CASE("the channel service is told what the channel needs", "[synaptic][SYN-13]") {
  synaptic_fixture x(2, {.size_max = 64});
  x.create_out(0, 1, 10, {.divisor = 4, .qos = 0x15});
  x.create_out(1, 0, 64);
  REQUIRE(x.connects.size() == 2);
  CHECK(x.connects[0].interval == 2s);
  CHECK(x.connects[0].size == 46);
  CHECK(x.connects[0].qos == 0x15);
  CHECK(x.connects[1].interval == 500ms);
  CHECK(x.connects[1].size == 108);
}

TEST_CASE("ends that differ in size or divisor both fail", "[synaptic][SYN-15]") {
  const bool out_first = GENERATE(true, false);
  const parameters in_wish{.divisor = GENERATE(std::uint8_t{1}, std::uint8_t{2})};
  const std::size_t in_size = in_wish.divisor == 2 ? 3 : 4;
  synaptic_fixture x(2);
  if (out_first) {
    x.create_out(0, 1, 3);
    x.run_ticks(1);
    x.create_in(1, 0, in_size, in_wish);
  } else {
    x.create_in(1, 0, in_size, in_wish);
    x.create_out(0, 1, 3);
  }
  x.run_ticks(1);
  for (std::size_t node = 0; node < 2; ++node) {
    const auto done = x.all<create_done>(node);
    REQUIRE(done.size() == 1);
    CHECK_FALSE(done[0].success);
    CHECK(done[0].is_out == (node == 0));
    CHECK(x.at(node).open_channels() == 0);
    CHECK(x.at(node).early_channels() == 0);
    CHECK_FALSE(x.at(node).deadline());
  }
}

TEST_CASE("the out end may be created first", "[synaptic][SYN-02][SYN-04]") {
  synaptic_fixture x(2);
  x.create_out(0, 1, 3);
  x.run_ticks(20);
  CHECK(x.events.empty());
  CHECK(x.at(1).early_channels() == 1);
  x.create_in(1, 0, 3);
  CHECK(x.all<create_done>(1).size() == 1);
  x.run_ticks(1);
  CHECK(x.all<create_done>(0).size() == 1);
  CHECK(x.at(1).early_channels() == 0);
}

TEST_CASE("an early channel gives way to a newer one of the same node", "[synaptic][SYN-17]") {
  synaptic_fixture x(2);
  x.create_out(0, 1, 3);
  x.run_ticks(1);
  x.restart(0, false);
  x.create_out(0, 1, 4);
  x.run_ticks(1);
  CHECK(x.at(1).early_channels() == 1);
  x.create_in(1, 0, 4);
  x.run_ticks(1);
  CHECK(x.all<create_done>(0).back().success);
  CHECK(x.at(1).early_channels() == 0);
  CHECK(x.open_ends(0) == 1);
  CHECK(x.open_ends(1) == 1);
}

TEST_CASE("an acknowledgement that is lost is sent again", "[synaptic][SYN-02]") {
  synaptic_fixture x(2);
  x.create_in(1, 0, 3);
  x.create_out(0, 1, 3);
  x.run_until(x.now + 11ms);
  x.loss = 1;
  x.run_until(x.now + 20ms);
  CHECK(x.all<create_done>(1).size() == 1);
  CHECK(x.all<create_done>(0).empty());
  x.loss = 0;
  x.run_until(x.now + 2s);
  CHECK(x.all<create_done>(1).size() == 1);
  CHECK(x.all<create_done>(0).size() == 1);
}

TEST_CASE("an end that stays alone fails after its patience", "[synaptic][SYN-02][SYN-04]") {
  synaptic_fixture x(2);
  SECTION("the channel service does not answer") {
    x.reaches_all = false;
  }
  SECTION("the channel service refuses") {
    x.connect_loss = 1;
  }
  SECTION("the other end does not answer") {
    x.loss = 1;
  }
  SECTION("the other end is not created") {}
  x.create_out(0, 1, 3);
  x.create_in(0, 1, 3);
  x.run_until(instant{31s});
  REQUIRE(x.all<create_done>(0).size() == 1);
  CHECK(x.all<create_done>(0)[0].is_out);
  CHECK_FALSE(x.all<create_done>(0)[0].success);
  x.run_until(instant{2min} - 1ms);
  CHECK(x.all<create_done>(0).size() == 1);
  x.run_until(instant{2min});
  REQUIRE(x.all<create_done>(0).size() == 2);
  CHECK_FALSE(x.all<create_done>(0)[1].success);
  for (std::size_t node = 0; node < 2; ++node) {
    CHECK(x.at(node).open_channels() == 0);
    CHECK(x.at(node).early_channels() == 0);
    CHECK_FALSE(x.at(node).deadline());
  }
}

TEST_CASE("disposing of an end that is not open yet is its failure", "[synaptic][SYN-05]") {
  synaptic_fixture x(2);
  const auto out = x.create_out(0, 1, 3);
  x.take(0, x.at(0).dispose(out));
  x.run_ticks(2);
  REQUIRE(x.all<create_done>(0).size() == 1);
  CHECK_FALSE(x.all<create_done>(0)[0].success);
  CHECK(x.at(1).early_channels() == 0);
  CHECK(x.is_quiet());
}

TEST_CASE("early channels are bounded", "[synaptic][SYN-17]") {
  synaptic_fixture x(4);
  for (std::size_t i = 1; i < 4; ++i)
    x.create_out(i, 0, 1);
  x.run_ticks(1);
  CHECK(x.at(0).early_channels() == 2);
  CHECK(x.at(0).counters().refused == 1);
  CHECK(x.all<create_done>(3).size() + x.all<create_done>(2).size() +
            x.all<create_done>(1).size() ==
        1);
}

TEST_CASE("a channel to ourselves needs no channel service", "[synaptic][SYN-14]") {
  synaptic_fixture x(1);
  const bool out_first = GENERATE(true, false);
  descriptor out, in;
  if (out_first) {
    out = x.create_out(0, 0, 2);
    in = x.create_in(0, 0, 2);
  } else {
    in = x.create_in(0, 0, 2);
    out = x.create_out(0, 0, 2);
  }
  CHECK(x.all<create_done>(0).size() == 2);
  CHECK_FALSE(x.at(0).start(out).refused);
  x.run_ticks(5);
  const auto updates = x.all<input_update>(0);
  REQUIRE(updates.size() == 10);
  CHECK(updates[9].channel == in);
  CHECK(updates[9].index == 1);
  CHECK(updates[9].status == input_status::updated);
  CHECK(x.at(0).read_input(in, 1) == value_of(0, 5, 1)); // of the same tick
  CHECK(x.connects.empty());
  CHECK(x.packets == 0);
  CHECK_FALSE(x.at(0).stop(out).refused);
  x.run_ticks(50);
  CHECK(x.all<input_update>(0).size() == 10);
  x.take(0, x.at(0).dispose(out_first ? out : in));
  CHECK(x.all<channel_failed>(0).size() == 1);
  x.take(0, x.at(0).dispose(out_first ? in : out));
  CHECK(x.at(0).open_channels() == 0);
  CHECK(x.all<channel_failed>(0).size() == 1);
}

TEST_CASE("ends of a channel to ourselves must agree too", "[synaptic][SYN-14][SYN-15]") {
  synaptic_fixture x(1);
  x.create_out(0, 0, 2);
  x.create_in(0, 0, 3);
  const auto done = x.all<create_done>(0);
  REQUIRE(done.size() == 2);
  CHECK_FALSE(done[0].success);
  CHECK_FALSE(done[1].success);
  CHECK(x.at(0).open_channels() == 0);
}
