// How remote streams end: time-outs, refusals, closing, the other end going away.
#include "support/catch.hpp"
#include "support/pick.hpp"
#include "unit/stream/fixture.hpp"

using namespace rubicon;
using namespace rubicon::stream;
using test::pick;
using test::reader_node;
using test::stream_fixture;
using test::writer_node;

namespace {

struct pair_of_ends {
  stream_fixture world{2};
  descriptor reader = open_reader();
  descriptor writer = open_writer();

  pair_of_ends() {
    world.run_for(1s);
    REQUIRE(world.events.size() == 2);
    world.events.clear();
  }

  descriptor open_reader() {
    return world.take(
        reader_node,
        world.open(reader_node, {.destination = stream_fixture::address(reader_node), .name = 7}));
  }
  descriptor open_writer() {
    return world.take(
        writer_node,
        world.open(writer_node, {.destination = stream_fixture::address(reader_node), .name = 7}));
  }
};

/// The success of the only event there is.
template <class T>
bool only_event_succeeds(const stream_fixture& world) {
  REQUIRE(world.events.size() == 1);
  return std::get<T>(world.events[0].second).success;
}

} // namespace

TEST_CASE("a write end that nobody answers fails in the end, once", "[stream][STR-19][MCK-02]") {
  stream_fixture world(2);
  const bool connects = GENERATE(true, false);
  world.service.reaches_all = connects;
  world.service.loss = 1;
  const auto writer = world.take(
      writer_node,
      world.open(writer_node, {.destination = stream_fixture::address(reader_node), .name = 7}));
  world.run_for(30s - 1ns);
  CHECK(world.events.empty());
  world.run_for(1ns);
  CHECK_FALSE(only_event_succeeds<open_done>(world));
  CHECK(world.at(writer_node).open_streams() == 0);
  CHECK(world.at(writer_node).close(writer).refused == failure::bad_descriptor);
  world.run_for(5ms);
  CHECK(world.at(reader_node).early_channels() == 0);
  CHECK_FALSE(world.at(writer_node).deadline());
  world.run_for(1h);
  CHECK(world.events.size() == 1);
  CHECK(world.at(writer_node).counters().open_failed == 1);
}

TEST_CASE("a connect that fails, fails the open", "[stream][STR-19][MCK-02]") {
  stream_fixture world(2);
  world.service.connect_loss = 1;
  world.take(
      writer_node,
      world.open(writer_node, {.destination = stream_fixture::address(reader_node), .name = 7}));
  world.run_for(5ms);
  CHECK_FALSE(only_event_succeeds<open_done>(world));
  CHECK(world.at(writer_node).open_streams() == 0);
}

TEST_CASE("a channel that comes after the open was given up is closed again", "[stream][STR-19]") {
  streams x;
  const mote_address self{island_id{1}, mote_id{2}};
  const auto opened =
      x.open_remote(self, {.destination = stream_fixture::address(5), .name = 7}, {});
  REQUIRE(pick<connect_channel>(opened.todo).size() == 1);
  const auto closed = x.close(opened.stream);
  CHECK_FALSE(pick<open_done>(closed.todo).at(0).success);
  CHECK(pick<disconnect>(closed.todo).empty());
  const auto todo = x.on_connected(opened.stream, channel_handle{3}, {});
  CHECK(pick<disconnect>(todo).at(0).channel == channel_handle{3});
  CHECK(x.on_connect_failed(opened.stream).empty());
}

TEST_CASE("a read end that no write end comes to fails in the end, once", "[stream][STR-19]") {
  stream_fixture world(2);
  world.take(
      reader_node,
      world.open(reader_node, {.destination = stream_fixture::address(reader_node), .name = 7}));
  world.run_for(2min - 1ns);
  CHECK(world.events.empty());
  world.run_for(1h);
  CHECK_FALSE(only_event_succeeds<open_done>(world));
  CHECK(world.at(reader_node).open_streams() == 0);
}

TEST_CASE("a channel whose stream nobody opens expires at both ends", "[stream][STR-19]") {
  stream_fixture world(2);
  const auto writer = world.take(
      writer_node,
      world.open(writer_node, {.destination = stream_fixture::address(reader_node), .name = 7}));
  world.run_for(1min);
  CHECK(only_event_succeeds<open_done>(world));
  CHECK(world.at(reader_node).early_channels() == 1);
  world.run_for(61s);
  CHECK(world.at(reader_node).early_channels() == 0);
  CHECK(world.at(reader_node).counters().expired == 1);
  CHECK(world.at(writer_node).write(writer, {}).refused == failure::ended);
}

TEST_CASE("repeating SS_OPEN does not keep a channel that nobody opens for", "[stream][STR-19]") {
  streams x;
  const channel_handle channel{3};
  CHECK(x.on_accepted(channel, stream_fixture::address(1), {}).empty());
  for (auto now = instant{1s}; now < instant{100s}; now += 10s)
    CHECK(x.on_channel_octets(channel, encode(open_message{7}), now).size() == 1);
  CHECK(x.deadline() == instant{1s} + 2min);
}

TEST_CASE("channels that say nothing do not stay", "[stream][STR-19]") {
  streams x;
  CHECK(x.on_accepted(channel_handle{3}, stream_fixture::address(1), {}).empty());
  REQUIRE(x.deadline());
  CHECK(pick<disconnect>(x.on_time(*x.deadline())).at(0).channel == channel_handle{3});
  CHECK(x.early_channels() == 0);
  CHECK_FALSE(x.deadline());
}

TEST_CASE("channels that come too early have a bounded table", "[stream][STR-14]") {
  streams x;
  for (std::uint32_t i = 0; i < 2; ++i)
    CHECK(x.on_accepted(channel_handle{i}, stream_fixture::address(1), {}).empty());
  const auto todo = x.on_accepted(channel_handle{2}, stream_fixture::address(1), {});
  CHECK(pick<disconnect>(todo).at(0).channel == channel_handle{2});
  CHECK(x.counters().refused == 1);
  CHECK(x.early_channels() == 2);
}

TEST_CASE("closing the write end lets the reader have what has arrived", "[stream][STR-05]") {
  pair_of_ends x;
  auto& [world, reader, writer] = x;
  world.take(writer_node, world.at(writer_node).write(writer, bytes{1}));
  world.take(writer_node, world.at(writer_node).write(writer, bytes{2}));
  world.run_for(1s);
  world.take(writer_node, world.at(writer_node).close(writer));
  CHECK(world.at(writer_node).open_streams() == 0);
  world.run_for(1s);
  CHECK(world.at(reader_node).open_streams() == 1);
  CHECK(world.events.empty());
  for (int i = 0; i < 2; ++i)
    world.take(reader_node, world.at(reader_node).read(reader, 1));
  CHECK(world.events.size() == 2);
  CHECK(world.at(reader_node).read(reader, 1).refused == failure::ended);
  CHECK_FALSE(world.at(reader_node).close(reader).refused);
  CHECK(world.at(reader_node).open_streams() == 0);
}

TEST_CASE("a pending read fails when the write end goes", "[stream][STR-05]") {
  pair_of_ends x;
  auto& [world, reader, writer] = x;
  world.take(reader_node, world.at(reader_node).read(reader, 1));
  const bool dies = GENERATE(true, false);
  if (dies)
    world.restart(writer_node);
  else
    world.take(writer_node, world.at(writer_node).close(writer));
  world.run_for(1s);
  CHECK_FALSE(only_event_succeeds<read_done>(world));
  CHECK(world.at(reader_node).read(reader, 1).refused == failure::ended);
}

TEST_CASE("closing the read end ends the write end", "[stream][STR-05]") {
  pair_of_ends x;
  auto& [world, reader, writer] = x;
  world.take(reader_node, world.at(reader_node).close(reader));
  world.run_for(1s);
  CHECK(world.events.empty());
  CHECK(world.at(writer_node).write(writer, bytes{1}).refused == failure::ended);
  CHECK_FALSE(world.at(writer_node).close(writer).refused);
  CHECK(world.at(writer_node).open_streams() == 0);
}

TEST_CASE("closing while opening ends the open as failed, at each phase", "[stream][MCK-02]") {
  stream_fixture world(2);
  const auto passed = GENERATE(0ms, 7ms, 12ms, 17ms);
  const auto writer = world.take(
      writer_node,
      world.open(writer_node, {.destination = stream_fixture::address(reader_node), .name = 7}));
  world.run_for(passed);
  world.take(writer_node, world.at(writer_node).close(writer));
  CHECK_FALSE(only_event_succeeds<open_done>(world));
  world.run_for(1s);
  CHECK(world.events.size() == 1);
  CHECK(world.at(writer_node).open_streams() == 0);
  CHECK(world.at(reader_node).early_channels() == 0);

  const auto reader = world.take(
      reader_node,
      world.open(reader_node, {.destination = stream_fixture::address(reader_node), .name = 7}));
  world.take(reader_node, world.at(reader_node).close(reader));
  CHECK(world.events.size() == 2);
}

TEST_CASE("a node that opens anew takes its name over, after the old stream has ended",
          "[stream][STR-05]") {
  pair_of_ends x;
  auto& [world, reader, writer] = x;
  world.take(reader_node, world.at(reader_node).read(reader, 1));
  world.service.delay_min = world.service.delay_max = 1min; // nobody hears of the death yet
  world.restart(writer_node);
  world.service.delay_min = world.service.delay_max = 5ms;
  const auto again = x.open_writer();
  world.run_for(1s);
  REQUIRE(world.events.size() == 2);
  CHECK_FALSE(std::get<read_done>(world.events[0].second).success);
  CHECK(std::get<open_done>(world.events[1].second).success);
  CHECK(world.at(reader_node).read(reader, 1).refused == failure::ended);
  world.take(reader_node, world.at(reader_node).close(reader));
  const auto second = x.open_reader();
  world.take(writer_node, world.at(writer_node).write(again, bytes{5}));
  world.run_for(5min); // late packets of the old channel do no harm
  world.take(reader_node, world.at(reader_node).read(second, 1));
  CHECK(std::get<read_done>(world.events.back().second).content == bytes{5});
}

TEST_CASE("a read end that opens late takes the newest channel of its write end",
          "[stream][STR-14]") {
  streams x;
  const mote_address self{island_id{1}, mote_id{2}};
  for (const std::uint32_t i : {1U, 2U}) {
    CHECK(x.on_accepted(channel_handle{i}, stream_fixture::address(5), {}).empty());
    const auto todo = x.on_channel_octets(channel_handle{i}, encode(open_message{7}), {});
    CHECK(pick<disconnect>(todo).size() == i - 1);
  }
  CHECK(x.early_channels() == 1);
  const auto reader = x.open_remote(self, {.destination = self, .name = 7}, {}).stream;
  CHECK(pick<disconnect>(x.close(reader).todo).at(0).channel == channel_handle{2});
  CHECK(x.early_channels() == 0);
}

TEST_CASE("another node cannot write into a stream that a node has to itself", "[stream]") {
  stream_fixture world(2);
  remote_request what{.destination = stream_fixture::address(reader_node), .name = 7};
  world.take(reader_node, world.open(reader_node, what));
  world.take(writer_node, world.open(writer_node, what));
  what.writes_to_self = true;
  world.take(reader_node, world.open(reader_node, what));
  CHECK(world.events.size() == 2);
  world.events.clear();
  world.run_for(1s);
  CHECK_FALSE(only_event_succeeds<open_done>(world));
  CHECK(world.at(reader_node).counters().refused == 1);
}

TEST_CASE("a second node that uses the same name is refused", "[stream]") {
  stream_fixture world(3);
  const bool is_read = GENERATE(true, false);
  if (is_read)
    world.take(
        reader_node,
        world.open(reader_node, {.destination = stream_fixture::address(reader_node), .name = 7}));
  const auto writer = world.take(
      writer_node,
      world.open(writer_node, {.destination = stream_fixture::address(reader_node), .name = 7}));
  world.run_for(1s);
  world.events.clear();
  world.take(2, world.open(2, {.destination = stream_fixture::address(reader_node), .name = 7}));
  world.run_for(1s);
  CHECK_FALSE(only_event_succeeds<open_done>(world));
  CHECK(world.at(reader_node).counters().refused == 1);
  CHECK_FALSE(world.at(writer_node).write(writer, {}).refused);
}

TEST_CASE("messages that their channel does not wait for are counted", "[stream]") {
  streams x;
  const channel_handle known{1};
  CHECK(x.on_channel_octets(channel_handle{9}, encode(open_message{7}), {}).empty());
  CHECK(x.on_accepted(known, stream_fixture::address(1), {}).empty());
  CHECK(x.on_channel_octets(known, encode(write_message{0, {1}}), {}).empty());
  CHECK(x.on_channel_octets(known, encode(open_ack_message{7}), {}).empty());
  CHECK(x.counters().strays == 3);
  CHECK(x.on_channel_octets(known, bytes{1, 2}, {}).empty());
  CHECK(x.counters().malformed == 1);
  CHECK(x.on_channel_closed(channel_handle{9}).empty());
  static_cast<void>(x.on_channel_octets(known, encode(open_message{7}), {}));
  const auto todo = x.on_channel_octets(known, encode(open_message{8}), {});
  CHECK(pick<disconnect>(todo).at(0).channel == known);
  CHECK(x.early_channels() == 0);
}
