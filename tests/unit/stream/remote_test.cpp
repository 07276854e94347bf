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

/// Events of one kind at a node, in order.
template <class T>
std::vector<T> events(const stream_fixture& world, std::size_t node) {
  std::vector<T> found;
  for (const auto& [where, what] : world.events) {
    if (const auto* x = std::get_if<T>(&what); x != nullptr && where.node == node)
      found.push_back(*x);
  }
  return found;
}

descriptor open_writer(stream_fixture& world, std::uint16_t name = 7) {
  return world.take(
      writer_node,
      world.open(writer_node, {.destination = stream_fixture::address(reader_node), .name = name}));
}

descriptor open_reader(stream_fixture& world, std::uint16_t name = 7) {
  return world.take(
      reader_node,
      world.open(reader_node, {.destination = stream_fixture::address(reader_node), .name = name}));
}

} // namespace

TEST_CASE("the write end opens with the acknowledgement, whoever opens first",
          "[stream][STR-11][STR-12][STR-13][STR-14][MCK-01][MCK-02]") {
  stream_fixture world(2);
  const bool reader_first = GENERATE(true, false);
  descriptor reader;
  if (reader_first)
    reader = open_reader(world);
  const auto writer = open_writer(world);
  CHECK(world.at(writer_node).write(writer, {}).refused == failure::not_open_yet);
  world.run_for(14ms); // connect 5 ms, connect-ack 5 ms, SS_OPEN 5 ms
  CHECK(world.events.empty());
  world.run_for(1ms);
  CHECK(events<open_done>(world, reader_node).size() == (reader_first ? 1U : 0U));
  CHECK(events<open_done>(world, writer_node).empty());
  world.run_for(5ms);
  const auto at_a = events<open_done>(world, writer_node);
  REQUIRE(at_a.size() == 1);
  CHECK(at_a[0].success);
  CHECK(at_a[0].stream == writer);
  CHECK(at_a[0].name == 7);
  if (!reader_first)
    reader = open_reader(world); // hears of it at once
  const auto at_b = events<open_done>(world, reader_node);
  REQUIRE(at_b.size() == 1);
  CHECK(at_b[0].success);
  CHECK(at_b[0].stream == reader);
  CHECK(at_b[0].name == 7);
  CHECK(world.packets == std::vector<bytes>{{1, 0, 7}, {2, 0, 7}});
  CHECK(world.at(reader_node).early_channels() == 0);
  world.run_for(1h);
  CHECK(world.events.size() == 2);
}

TEST_CASE("a record goes over the channel and serves a read", "[stream][STR-16][MCK-08]") {
  stream_fixture world(2);
  const auto reader = open_reader(world);
  const auto writer = open_writer(world);
  world.run_for(1s);
  CHECK(world.take(reader_node, world.at(reader_node).read(reader, 100)) == reader);
  world.take(writer_node, world.at(writer_node).write(writer, bytes{0xca, 0xfe}));
  world.take(writer_node, world.at(writer_node).write(writer, bytes{0xbe}));
  CHECK(world.packets.at(2) == bytes{3, 0, 0, 0xca, 0xfe});
  CHECK(world.packets.at(3) == bytes{3, 0, 1, 0xbe});
  world.run_for(5ms);
  REQUIRE(events<read_done>(world, reader_node).size() == 1);
  CHECK(events<read_done>(world, reader_node)[0].content == bytes{0xca, 0xfe});
  world.take(reader_node, world.at(reader_node).read(reader, 100));
  CHECK(events<read_done>(world, reader_node).at(1).content == bytes{0xbe});
  CHECK(events<read_done>(world, writer_node).empty());
}

TEST_CASE("the wrong end refuses", "[stream][STR-17][MCK-06]") {
  stream_fixture world(2);
  const auto reader = open_reader(world);
  const auto writer = open_writer(world);
  CHECK(world.at(writer_node).read(writer, 1).refused == failure::illegal_operation);
  CHECK(world.at(reader_node).write(reader, {}).refused == failure::illegal_operation);
  CHECK(world.at(reader_node).read(reader, 1).refused == failure::not_open_yet);
  world.run_for(1s);
  CHECK(world.at(writer_node).read(writer, 1).refused == failure::illegal_operation);
  CHECK(world.at(reader_node).write(reader, {}).refused == failure::illegal_operation);
}

TEST_CASE("what the write end wishes goes along with the connect", "[stream][NRG-01]") {
  stream_fixture world(2);
  world.take(writer_node,
             world.open(writer_node,
                        {.destination = {own_island, stream_fixture::address(reader_node).mote},
                         .name = 7,
                         .rate = 250ms,
                         .qos = qos_reliable | 0x30,
                         .buffer_size = 20}));
  REQUIRE(world.connects.size() == 1);
  const auto& x = world.connects[0];
  CHECK(x.destination == stream_fixture::address(reader_node));
  CHECK(x.interval == 250ms);
  CHECK(x.size == 23);
  CHECK(x.qos == 0x31);
}

TEST_CASE("a destination decides the role, under each of a node's names", "[stream][STR-11]") {
  stream_fixture world(2);
  const mote_address names[] = {stream_fixture::address(reader_node),
                                {own_island, stream_fixture::address(reader_node).mote},
                                {own_island, own_mote}};
  for (const auto& x : names)
    world.take(reader_node, world.open(reader_node, {.destination = x, .name = x.mote.value}));
  CHECK(world
            .open(reader_node,
                  {.destination = {stream_fixture::address(reader_node).island, own_mote},
                   .name = own_mote.value})
            .refused == failure::already_open);
  CHECK(world.connects.empty());
  world.take(reader_node,
             world.open(reader_node, {.destination = {own_island, no_mote}, .name = 50}));
  REQUIRE(world.connects.size() == 1);
  CHECK(world.connects[0].destination ==
        mote_address{stream_fixture::address(reader_node).island, no_mote});
}

TEST_CASE("an open that makes no sense is refused", "[stream][MCK-01]") {
  stream_fixture world(2);
  const auto to_b = stream_fixture::address(reader_node);
  const auto refused = [&](remote_request x) { return world.open(writer_node, x).refused; };
  CHECK(refused({.destination = {own_island, broadcast_mote}}) == failure::bad_argument);
  CHECK(refused({.destination = to_b, .rate = std::chrono::milliseconds(-1)}) ==
        failure::bad_argument);
  CHECK(refused({.destination = to_b, .buffer_size = 0}) == failure::bad_argument);
  CHECK(refused({.destination = to_b, .buffer_size = 106}) == failure::bad_argument);
  CHECK(refused({.destination = to_b, .queue_size = 0}) == failure::bad_argument);
  CHECK_FALSE(refused({.destination = to_b, .name = 1, .buffer_size = 105}));
  CHECK(refused({.destination = to_b, .name = 1}) == failure::already_open);
  CHECK_FALSE(refused({.destination = to_b, .name = 2}));
  CHECK_FALSE(
      refused({.destination = stream_fixture::address(writer_node), .name = 1})); // the other role
  CHECK(world.at(writer_node).open_streams() == 3);
}

TEST_CASE("two opens at the same time are told apart by name", "[stream][STR-12]") {
  stream_fixture world(2);
  const auto first = open_writer(world, 7);
  const auto second = open_writer(world, 8);
  const auto reader_of_second = open_reader(world, 8);
  const auto reader_of_first = open_reader(world, 7);
  world.run_for(1s);
  world.take(writer_node, world.at(writer_node).write(first, bytes{1}));
  world.take(writer_node, world.at(writer_node).write(second, bytes{2}));
  world.run_for(1s);
  world.take(reader_node, world.at(reader_node).read(reader_of_first, 1));
  world.take(reader_node, world.at(reader_node).read(reader_of_second, 1));
  const auto read = events<read_done>(world, reader_node);
  REQUIRE(read.size() == 2);
  CHECK(read[0].content == bytes{1});
  CHECK(read[1].content == bytes{2});
}

TEST_CASE("the queue of a remote stream is at the read end", "[stream][STR-03][STR-15]") {
  stream_fixture world(2);
  const auto reader = world.take(
      reader_node, world.open(reader_node, {.destination = stream_fixture::address(reader_node),
                                            .name = 7,
                                            .queue_size = 2}));
  const auto writer = open_writer(world);
  world.run_for(1s);
  for (std::uint8_t i = 1; i <= 4; ++i)
    world.take(writer_node, world.at(writer_node).write(writer, bytes{i}));
  CHECK(world.at(writer_node).counters().stored == 0);
  world.run_for(1s);
  CHECK(world.at(reader_node).counters().dropped == 2);
  world.take(reader_node, world.at(reader_node).read(reader, 1));
  CHECK(events<read_done>(world, reader_node).at(0).content == bytes{3});
}

TEST_CASE("records longer than a buffer are refused at the write end and dropped at the read end",
          "[stream][MCK-08]") {
  stream_fixture world(2);
  const auto reader = world.take(
      reader_node, world.open(reader_node, {.destination = stream_fixture::address(reader_node),
                                            .name = 7,
                                            .buffer_size = 4}));
  const auto writer = world.take(
      writer_node, world.open(writer_node, {.destination = stream_fixture::address(reader_node),
                                            .name = 7,
                                            .buffer_size = 6}));
  world.run_for(1s);
  CHECK(world.at(writer_node).write(writer, bytes(7)).refused == failure::too_long);
  world.take(writer_node, world.at(writer_node).write(writer, bytes(5)));
  world.take(writer_node, world.at(writer_node).write(writer, bytes(4)));
  world.run_for(1s);
  CHECK(world.at(reader_node).counters().oversized == 1);
  world.take(reader_node, world.at(reader_node).read(reader, 10));
  CHECK(events<read_done>(world, reader_node).at(0).content == bytes(4));
}

namespace {

/// Writes records of one octet, and what a reader gets that opens after them.
std::vector<bytes> read_late(stream_fixture& world, descriptor writer, unsigned written) {
  for (unsigned i = 1; i <= written; ++i) {
    const bytes record{static_cast<std::uint8_t>(i)};
    world.take(writer_node, world.at(writer_node).write(writer, record));
    world.run_for(100ms);
  }
  const auto reader = open_reader(world);
  std::vector<bytes> got;
  for (;;) {
    const auto before = events<read_done>(world, reader_node).size();
    world.take(reader_node, world.at(reader_node).read(reader, 10));
    const auto all = events<read_done>(world, reader_node);
    if (all.size() == before)
      return got;
    got.push_back(all.back().content);
  }
}

} // namespace

TEST_CASE("records that come before the reader has opened are read when it has",
          "[stream][STR-13][STR-14]") {
  stream_fixture world(2);
  const auto writer = open_writer(world);
  world.run_for(1s);
  CHECK(read_late(world, writer, 3) == std::vector<bytes>{{1}, {2}, {3}});
  CHECK(world.at(reader_node).counters().unclaimed == 0);
  CHECK(world.at(reader_node).counters().lost == 0);
  CHECK(world.at(reader_node).counters().resumed == 0);
}

TEST_CASE("of records that come before the reader has opened the newest are kept", "[stream]") {
  static constexpr unsigned kept = 102 / 2; // an octet each, and its length
  const auto written = GENERATE(as<unsigned>(), kept - 1, kept, kept + 1, 3 * kept);
  stream_fixture world(2);
  const auto writer = open_writer(world);
  world.run_for(1s);
  const auto got = read_late(world, writer, written);
  REQUIRE(got.size() == std::min(written, kept));
  CHECK(got.front() == bytes{static_cast<std::uint8_t>(written - got.size() + 1)});
  CHECK(got.back() == bytes{static_cast<std::uint8_t>(written)});
  CHECK(world.at(reader_node).counters().unclaimed == written - got.size());
  CHECK(world.at(reader_node).counters().lost == 0);
}

TEST_CASE("records that nobody opens for are counted", "[stream]") {
  const auto end = GENERATE(as<std::string>(), "too late", "the channel breaks");
  CAPTURE(end);
  stream_fixture world(2);
  const auto writer = open_writer(world);
  world.run_for(1s);
  world.take(writer_node, world.at(writer_node).write(writer, bytes{1}));
  world.run_for(1s);
  CHECK(world.at(reader_node).counters().unclaimed == 0);
  if (end == "the channel breaks")
    world.cut(1s);
  world.run_for(3min);
  CHECK(world.at(reader_node).counters().unclaimed == 1);
  CHECK(world.at(reader_node).early_channels() == 0);
}

TEST_CASE("SS_OPEN is repeated until it is acknowledged", "[stream][STR-13]") {
  stream_fixture world(2);
  open_reader(world);
  const auto writer = open_writer(world);
  world.service.loss = 1;
  world.run_for(5s);
  CHECK(world.packets == std::vector<bytes>(3, {1, 0, 7}));
  world.service.loss = 0;
  world.run_for(2s);
  REQUIRE(events<open_done>(world, writer_node).size() == 1);
  CHECK(events<open_done>(world, writer_node)[0].stream == writer);
  CHECK(events<open_done>(world, writer_node)[0].success);
  const auto sent = world.packets.size();
  world.run_for(1min);
  CHECK(world.packets.size() == sent);
}

TEST_CASE("an open waits as long as radios sleep at both ends", "[stream][STR-13][STR-19]") {
  streams x;
  const mote_address self{island_id{1}, mote_id{2}};
  x.set_answer_slack(8s);
  const auto answer =
      x.open_remote(self, {.destination = {island_id{2}, mote_id{3}}, .name = 7}, {}, 100s);
  CHECK(x.deadline() == instant{} + 30s + 2 * 108s);
  static_cast<void>(x.on_connected(answer.stream, channel_handle{4}, {}));
  CHECK(x.deadline() == instant{} + 2s + 108s); // SS_OPEN again
  static_cast<void>(x.on_accepted(channel_handle{5}, {island_id{3}, mote_id{9}}, {}, 1s));
  CHECK(x.deadline() == instant{} + 30s + 2 * 9s);
}

TEST_CASE("a lost acknowledgement is given again", "[stream][STR-13]") {
  for (const bool opens_first : {true, false}) {
    streams x;
    const mote_address self{island_id{1}, mote_id{2}};
    const channel_handle channel{4};
    if (opens_first)
      CHECK_FALSE(x.open_remote(self, {.destination = self, .name = 7}, {}).refused);
    CHECK(x.on_accepted(channel, {island_id{1}, mote_id{9}}, {}).empty());
    for (int i = 0; i < 3; ++i) {
      const auto todo = x.on_channel_octets(channel, encode(open_message{7}), {});
      CHECK(pick<send_on_channel>(todo).at(0).octets == encode(open_ack_message{7}));
      CHECK(pick<open_done>(todo).size() == (opens_first && i == 0 ? 1U : 0U));
    }
  }
}

TEST_CASE("lost, repeated and late records are counted; the order is kept", "[stream][STR-16]") {
  streams x;
  const mote_address self{island_id{1}, mote_id{2}};
  const channel_handle channel{4};
  const auto reader = x.open_remote(self, {.destination = self, .name = 7, .queue_size = 9}, {});
  CHECK(x.on_accepted(channel, {island_id{1}, mote_id{9}}, {}).empty());
  static_cast<void>(x.on_channel_octets(channel, encode(open_message{7}), {}));
  for (const auto i : bytes{0, 0, 3, 2, 4, 3}) {
    const write_message record{i, {i}};
    CHECK(x.on_channel_octets(channel, encode(record), {}).empty());
  }
  CHECK(x.counters().lost == 2);
  CHECK(x.counters().repeated == 3);
  for (const auto i : bytes{0, 3, 4})
    CHECK(pick<read_done>(x.read(reader.stream, 1).todo).at(0).content == bytes{i});
  CHECK(x.read(reader.stream, 1).todo.empty());
}

TEST_CASE("sequence numbers begin again after the last", "[stream]") {
  stream_fixture world(2);
  const auto reader = open_reader(world);
  const auto writer = open_writer(world);
  world.run_for(1s);
  for (int i = 0; i < 65'540; ++i)
    world.take(writer_node, world.at(writer_node).write(writer, bytes{1}));
  world.run_for(1s);
  CHECK(world.at(reader_node).counters().stored == 65'540);
  CHECK(world.at(reader_node).counters().lost == 0);
  CHECK(world.at(reader_node).counters().repeated == 0);
  CHECK_FALSE(world.at(reader_node).close(reader).refused);
}

TEST_CASE("a node may stream to itself", "[stream][STR-01]") {
  stream_fixture world(1);
  const bool reader_first = GENERATE(true, false);
  remote_request what{.destination = {own_island, own_mote}, .name = 7};
  const auto open_reader_here = [&] {
    return world.take(writer_node, world.open(writer_node, what));
  };
  const auto open_writer_here = [&] {
    auto writing = what;
    writing.writes_to_self = true;
    return world.take(writer_node, world.open(writer_node, writing));
  };
  descriptor reader = reader_first ? open_reader_here() : descriptor{};
  const auto writer = open_writer_here();
  if (!reader_first) {
    CHECK_FALSE(world.at(writer_node).write(writer, bytes{9}).refused);
    CHECK(world.at(writer_node).counters().unclaimed == 1);
    reader = open_reader_here();
  }
  CHECK(events<open_done>(world, writer_node).size() == 2);
  CHECK(world.connects.empty());
  world.take(writer_node, world.at(writer_node).read(reader, 1));
  world.take(writer_node, world.at(writer_node).write(writer, bytes{1}));
  CHECK(events<read_done>(world, writer_node).at(0).content == bytes{1});

  world.take(writer_node, world.at(writer_node).write(writer, bytes{2}));
  world.take(writer_node, world.at(writer_node).close(writer));
  world.take(writer_node, world.at(writer_node).read(reader, 1));
  CHECK(events<read_done>(world, writer_node).at(1).content == bytes{2});
  CHECK(world.at(writer_node).read(reader, 1).refused == failure::ended);
  world.take(writer_node, world.at(writer_node).close(reader));
  CHECK(world.at(writer_node).open_streams() == 0);
}
