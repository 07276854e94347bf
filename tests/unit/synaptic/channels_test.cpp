#include "support/catch.hpp"
#include "support/pick.hpp"
#include "unit/synaptic/fixture.hpp"

using namespace rubicon;
using namespace rubicon::synaptic;
using test::synaptic_fixture;
using test::value_of;

namespace {

const channels_config pc{.channels_max = 64, .early_max = 8, .size_max = 64};

/// A channel from node 0 to node 1, open at both ends.
struct joined {
  explicit joined(std::size_t size = 3, parameters x = {}, channels_config config = {})
      : world(2, config) {
    out = world.create_out(0, 1, size, x);
    in = world.create_in(1, 0, size, x);
    world.run_ticks(1);
    REQUIRE(world.all<create_done>(0).size() == 1);
    REQUIRE(world.all<create_done>(1).size() == 1);
    REQUIRE(world.all<create_done>(0)[0].success);
    REQUIRE(world.all<create_done>(1)[0].success);
    world.events.clear();
  }

  void start() { REQUIRE_FALSE(world.at(0).start(out).refused); }

  std::size_t count(input_status status) {
    std::size_t found = 0;
    for (const auto& x : world.all<input_update>(1))
      found += x.status == status ? 1U : 0U;
    return found;
  }

  synaptic_fixture world;
  descriptor out, in;
};

} // namespace

TEST_CASE("a vector is told and shown at the tick after", "[synaptic][SYN-06][SYN-08][SYN-10]") {
  joined x;
  x.world.run_ticks(1);
  CHECK(x.world.vectors.empty());
  x.start(); // tick 3 is the next
  const auto first = x.world.tick;
  x.world.run_ticks(1);
  REQUIRE(x.world.vectors.size() == 1);
  CHECK(x.world.vectors[0].tick == first);
  CHECK(x.world.all<input_update>(1).empty());
  CHECK(x.world.at(1).read_input(x.in, 2) == 0.0F);
  x.world.run_ticks(1);
  const auto updates = x.world.all<input_update>(1);
  REQUIRE(updates.size() == 3);
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(updates[i].channel == x.in);
    CHECK(updates[i].index == i);
    CHECK(updates[i].status == input_status::updated);
    CHECK(x.world.at(1).read_input(x.in, i) == value_of(0, first, i));
  }
}

TEST_CASE("without loss nothing is missed", "[synaptic][SYN-10]") {
  joined x(10);
  x.start();
  x.world.run_ticks(101);
  CHECK(x.count(input_status::updated) == 1000);
  CHECK(x.count(input_status::missed) == 0);
}

TEST_CASE("a start within a tick takes effect at the next", "[synaptic][SYN-06]") {
  channels x;
  const mote_address self{island_id{1}, mote_id{1}};
  const mote_address other{island_id{1}, mote_id{2}};
  const auto out = x.create_out(self, other, 1, {}, {}).channel;
  CHECK(x.start(out).refused == failure::not_open_yet);
  CHECK(x.stop(out).refused == failure::not_open_yet);
  CHECK(x.write_output(out, 0, 1) == failure::not_open_yet);
  static_cast<void>(x.on_connected(out, channel_handle{5}, {}));
  static_cast<void>(x.on_channel_octets(channel_handle{5}, encode(open_ack_message{})));
  CHECK_FALSE(x.deadline());
  x.set_slot(30ms);
  CHECK(x.on_tick(7, instant{1s}).empty());
  CHECK_FALSE(x.start(out).refused);
  CHECK_FALSE(x.deadline());
  CHECK(x.on_tick(8, instant{2s}).empty());
  CHECK(x.deadline() == instant{2030ms});
  CHECK_FALSE(x.write_output(out, 0, 1.0F)); // as an application does in its clock_tick
  CHECK(x.on_time(instant{2029ms}).empty());
  const auto sent = test::pick<send_on_channel>(x.on_time(instant{2030ms}));
  REQUIRE(sent.size() == 1);
  CHECK(sent[0].channel == channel_handle{5});
  CHECK(to_hex(sent[0].octets) == "1400000008003f800000");
  CHECK_FALSE(x.deadline());
}

TEST_CASE("sends of two nodes are as far apart as their slots", "[synaptic][SYN-16]") {
  synaptic_fixture x(16);
  for (std::size_t i = 0; i < 16; ++i) {
    x.at(i).set_slot(25ms * static_cast<int>(i));
    const auto out = x.create_out(i, (i + 1) % 16, 1);
    x.create_in((i + 1) % 16, i, 1);
    x.run_until(x.now + 100ms);
    REQUIRE_FALSE(x.at(i).start(out).refused);
  }
  std::vector<instant> times;
  for (std::size_t i = 0; i < 16; ++i) {
    static_cast<void>(x.at(i).on_tick(1, x.now));
    times.push_back(*x.at(i).deadline());
  }
  for (std::size_t i = 1; i < 16; ++i)
    CHECK(times[i] - times[i - 1] == 25ms);
}

TEST_CASE("stop works once, and the in end rests", "[synaptic][SYN-07]") {
  joined x;
  CHECK(x.world.at(0).stop(x.out).refused == failure::not_active);
  x.start();
  x.start(); // once more does nothing
  x.world.run_ticks(5);
  const auto packets = x.world.packets;
  x.world.take(0, x.world.at(0).stop(x.out));
  CHECK(x.world.at(0).stop(x.out).refused == failure::not_active);
  x.world.run_ticks(30);
  CHECK(x.world.packets == packets + 2); // it is acknowledged
  CHECK(x.world.vectors.size() == 5);
  CHECK(x.count(input_status::updated) == 15);
  CHECK(x.count(input_status::missed) == 0);
  x.start();
  x.world.run_ticks(6);
  CHECK(x.count(input_status::updated) == 30);
  CHECK(x.count(input_status::missed) == 0);
}

TEST_CASE("a stop is repeated until it has arrived", "[synaptic][SYN-07]") {
  joined x;
  x.start();
  x.world.run_ticks(3);
  x.world.loss = 1;
  x.world.take(0, x.world.at(0).stop(x.out));
  x.world.run_ticks(4);
  CHECK(x.count(input_status::missed) == 9);
  x.world.loss = 0;
  x.world.run_ticks(40);
  CHECK(x.count(input_status::missed) == 12); // the stop came after that tick had begun
  CHECK(x.world.all<channel_failed>(1).empty());
}

TEST_CASE("a stop is repeated until its own acknowledgement has come", "[synaptic][SYN-07]") {
  joined x;
  x.start();
  x.world.run_ticks(3);
  auto& out = x.world.at(0);
  const auto sent = test::pick<send_on_channel>(out.stop(x.out).todo);
  REQUIRE(sent.size() == 1);
  const auto last = std::get<stop_message>(*decode_message(sent[0].octets)).tick;
  const auto repeats = [&] {
    static_cast<void>(out.on_tick(x.world.tick++, x.world.now));
    return test::pick<send_on_channel>(out.on_time(x.world.now + 100ms)).size();
  };
  const auto acknowledge = [&](std::uint32_t tick) {
    static_cast<void>(out.on_channel_octets(sent[0].channel, encode(stop_ack_message{tick})));
  };
  CHECK(repeats() == 1);
  acknowledge(last - 1); // of a stop before the last start
  CHECK(repeats() == 1);
  acknowledge(last);
  CHECK(repeats() == 0);
}

TEST_CASE("a stop before the slot keeps that tick's vector back", "[synaptic][SYN-07]") {
  joined x;
  x.start();
  x.world.run_ticks(2);
  auto& out = x.world.at(0);
  CHECK(out.on_tick(x.world.tick, x.world.now).empty());
  const auto todo = test::pick<send_on_channel>(out.stop(x.out).todo);
  REQUIRE(todo.size() == 1);
  CHECK(to_hex(todo[0].octets) == "1500000003"); // of the tick before
  x.start();                                     // takes the stop back
  CHECK(out.on_time(x.world.now + 100ms).empty());
}

TEST_CASE("start, stop and write are the out end's, read is the in end's",
          "[synaptic][SYN-06][SYN-08][SYN-09]") {
  joined x;
  CHECK(x.world.at(1).start(x.in).refused == failure::illegal_operation);
  CHECK(x.world.at(1).stop(x.in).refused == failure::illegal_operation);
  CHECK(x.world.at(1).write_output(x.in, 0, 1) == failure::illegal_operation);
  CHECK(x.world.at(0).write_output(x.out, 3, 1) == failure::bad_argument);
  CHECK_FALSE(x.world.at(0).write_output(x.out, 2, 1));
  CHECK(x.world.at(1).counters().bad_reads == 0);
  CHECK_FALSE(x.world.at(1).read_input(x.in, 3));
  CHECK_FALSE(x.world.at(1).read_input(descriptor{77}, 0));
  CHECK_FALSE(x.world.at(0).read_input(x.out, 0));
  CHECK(x.world.at(1).counters().bad_reads == 2);
  CHECK(x.world.at(0).counters().bad_reads == 1);
}

TEST_CASE("a disposed channel is gone at both ends", "[synaptic][SYN-05][SYN-17]") {
  joined x;
  x.start();
  x.world.run_ticks(3);
  const bool out_first = GENERATE(true, false);
  const std::size_t node = out_first ? 0 : 1;
  const auto id = out_first ? x.out : x.in;
  const auto other = out_first ? x.in : x.out;
  x.world.take(node, x.world.at(node).dispose(id));
  CHECK(x.world.at(node).dispose(id).refused == failure::bad_descriptor);
  CHECK(x.world.at(node).start(id).refused == failure::bad_descriptor);
  CHECK(x.world.at(node).stop(id).refused == failure::bad_descriptor);
  CHECK(x.world.at(node).write_output(id, 0, 1) == failure::bad_descriptor);
  CHECK(x.world.at(node).open_channels() == 0);
  x.world.run_ticks(1);
  const auto failed = x.world.all<channel_failed>(1 - node);
  REQUIRE(failed.size() == 1);
  CHECK(failed[0].channel == other);
  if (!out_first)
    CHECK(x.world.at(0).start(other).refused == failure::ended);
  CHECK_FALSE(x.world.at(1 - node).read_input(other, 0));
  x.world.take(1 - node, x.world.at(1 - node).dispose(other));
  CHECK(x.world.all<channel_failed>(node).empty());
  const auto again = x.world.create_out(0, 1, 3);
  CHECK(again != x.out);
  x.world.create_in(1, 0, 3);
  x.world.run_ticks(1);
  CHECK(x.world.all<create_done>(0).back().success);
}

TEST_CASE("a channel between the same nodes is refused while there is one",
          "[synaptic][SYN-01][SYN-03]") {
  joined x;
  auto& world = x.world;
  const auto other = world.address(1);
  const auto self = world.address(0);
  CHECK(world.at(0).create_out(self, other, 3, {}, world.now).refused == failure::already_open);
  CHECK(world.at(1).create_in(other, self, 2, {}, world.now).refused == failure::already_open);
  world.create_out(1, 0, 3); // the other direction
  world.create_in(0, 1, 3);
  world.run_ticks(1);
  CHECK(world.all<create_done>(0).back().success);
  CHECK(world.all<create_done>(1).back().success);
}

TEST_CASE("vectors of several packets arrive whole", "[synaptic][SYN-12]") {
  joined x(64, {}, pc);
  x.start();
  x.world.run_ticks(3);
  CHECK(x.count(input_status::updated) == 128);
  CHECK(x.world.at(1).read_input(x.in, 63) == value_of(0, x.world.tick - 2, 63));
}

TEST_CASE("with divisor 2 there is a vector every second tick", "[synaptic][SYN-13]") {
  joined x(2, {.divisor = 2});
  x.start();
  x.world.run_ticks(20);
  CHECK(x.world.vectors.size() == 10);
  for (const auto& y : x.world.vectors)
    CHECK(y.tick % 2 == 0);
  for (const auto& y : x.world.events)
    CHECK(y.tick % 2 == 1);
  CHECK(x.count(input_status::updated) == 20);
  CHECK(x.count(input_status::missed) == 0);
}

TEST_CASE("a silent peer is missed, then its channel fails", "[synaptic][SYN-17]") {
  joined x;
  x.start();
  x.world.run_ticks(3);
  x.world.events.clear();
  const auto last = x.world.at(1).read_input(x.in, 0);
  x.world.restart(0, false);
  x.world.run_ticks(20);
  CHECK(x.count(input_status::updated) == 3);
  CHECK(x.count(input_status::missed) == 57);
  CHECK(x.world.all<channel_failed>(1).empty());
  CHECK(x.world.at(1).read_input(x.in, 0) != last); // of the last vector sent
  x.world.run_ticks(1);
  CHECK(x.count(input_status::missed) == 60);
  REQUIRE(x.world.all<channel_failed>(1).size() == 1);
  CHECK(x.world.all<channel_failed>(1)[0].channel == x.in);
  x.world.run_ticks(30);
  CHECK(x.count(input_status::missed) == 60);
  CHECK_FALSE(x.world.at(1).read_input(x.in, 0));
  CHECK(x.world.at(1).open_channels() == 1);
  CHECK_FALSE(x.world.at(1).dispose(x.in).refused);
  CHECK(x.world.at(1).open_channels() == 0);
}

TEST_CASE("a peer that comes again gets a new channel", "[synaptic][SYN-17]") {
  joined x;
  x.start();
  x.world.run_ticks(3);
  x.world.restart(0, false);
  const auto out = x.world.create_out(0, 1, 3);
  x.world.run_ticks(1);
  REQUIRE(x.world.all<channel_failed>(1).size() == 1);
  const auto in = x.world.create_in(1, 0, 3); // before the failed one is disposed of
  CHECK(in != x.in);
  x.world.run_ticks(1);
  CHECK(x.world.all<create_done>(0).back().success);
  CHECK_FALSE(x.world.at(0).start(out).refused);
  x.world.events.clear();
  x.world.run_ticks(2);
  CHECK(x.count(input_status::updated) == 3);
}

TEST_CASE("ticks that are left out are no missed vectors", "[synaptic][SYN-10][CLK-05]") {
  joined x;
  x.start();
  x.world.run_ticks(5);
  x.world.events.clear();
  x.world.tick = GENERATE(900U, 2U);
  x.world.run_ticks(10);
  CHECK(x.count(input_status::missed) == 0);
  CHECK(x.count(input_status::updated) == 27);
  CHECK(x.world.at(1).counters().leaps == 1);
}

TEST_CASE("what is malformed or out of place is counted", "[synaptic][SYN-12]") {
  joined x;
  auto& in = x.world.at(1);
  const channel_handle handle{1};
  const auto octets = [&](const char* hex) {
    CHECK(in.on_channel_octets(handle, *from_hex(hex)).empty());
  };
  octets("");
  octets("14 00000002");
  octets("14 00000002 03 3f800000"); // index 3 of 3
  octets("14 00000002 ff 3f800000 3f800000");
  CHECK(in.counters().malformed == 4);
  octets("12");
  octets("13");
  octets("16 00000000");
  octets("11 04 01"); // of another size
  CHECK(in.counters().strays == 4);
  CHECK(in.on_channel_octets(channel_handle{99}, *from_hex("11 01 01")).empty());
  CHECK(in.counters().strays == 5);
  CHECK(x.world.at(0).on_channel_octets(channel_handle{0}, *from_hex("13")).empty());
  CHECK(x.world.at(0).counters().strays == 1);
}

TEST_CASE("all channels fit a mote", "[synaptic][SYN-01]") {
  CHECK(channels().footprint() < 600);
  CHECK(channels(pc).footprint() > channels().footprint());
}
