// Remote streams whose records must all arrive: acks, repeats, full queues, and the end.
#include "support/catch.hpp"
#include "unit/stream/fixture.hpp"

using namespace rubicon;
using namespace rubicon::stream;
using test::channel_service;
using test::reader_node;
using test::stream_fixture;
using test::writer_node;

namespace {

struct opened_stream {
  explicit opened_stream(channel_service quality, std::uint8_t qos, std::uint64_t seed = 1)
      : world(2, {}, seed) {
    reader = world.take(reader_node, world.open(reader_node, {.destination = address(1)}));
    writer =
        world.take(writer_node, world.open(writer_node, {.destination = address(1), .qos = qos}));
    world.run_for(1s);
    world.service = quality;
  }

  static mote_address address(std::size_t node) { return stream_fixture::address(node); }

  /// The records that have been read.
  [[nodiscard]] std::vector<int> read() const {
    std::vector<int> all;
    for (const auto& [where, what] : world.events) {
      if (const auto* x = std::get_if<read_done>(&what); x != nullptr && x->success)
        all.push_back(x->content.at(0));
    }
    return all;
  }

  void ask() {
    auto asked = world.at(reader_node).read(reader, 1);
    if (!asked.refused)
      world.take(reader_node, std::move(asked));
  }

  bool write(int number) {
    auto written =
        world.at(writer_node).write(writer, bytes{static_cast<std::uint8_t>(number)}, world.now);
    if (written.refused)
      return false;
    world.take(writer_node, std::move(written));
    return true;
  }

  stream_fixture world;
  descriptor reader;
  descriptor writer;
};

constexpr channel_service bad{.delay_min = 5ms, .delay_max = 900ms, .loss = 0.3, .repetition = 0.2};

} // namespace

TEST_CASE("of a reliable stream all records arrive, once and in order",
          "[stream][MCK-01][STR-16][IF-05]") {
  const std::uint8_t qos = GENERATE(qos_reliable, qos_every_value);
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    opened_stream x(bad, qos, seed);
    std::vector<int> written;
    for (int i = 0; written.size() < 100; ++i) {
      if (x.write(static_cast<int>(written.size())))
        written.push_back(static_cast<int>(written.size()));
      x.ask();
      x.world.run_for(500ms);
      REQUIRE(i < 2000);
    }
    for (int i = 0; i < 200; ++i) {
      x.ask();
      x.world.run_for(1s);
    }
    CHECK(x.read() == written);
    CHECK(x.world.at(writer_node).counters().resent > 0);
    CHECK(x.world.at(writer_node).counters().unconfirmed == 0);
    CHECK_FALSE(x.world.at(writer_node).has_ended(x.writer));
    CHECK_FALSE(x.world.at(writer_node).deadline()); // nothing is waited for
  }
}

TEST_CASE("a stream that asks for nothing is neither acked nor repeated", "[stream][STR-16]") {
  opened_stream x({}, 0);
  const auto before = x.world.packets.size();
  for (int i = 0; i < 20; ++i)
    CHECK(x.write(i));
  x.world.run_for(1min);
  CHECK(x.world.packets.size() == before + 20);
}

TEST_CASE("a reader that does not read lets a reliable writer wait, and loses nothing",
          "[stream][STR-03][MCK-18]") {
  opened_stream x({}, qos_reliable);
  int written = 0;
  for (int i = 0; i < 40; ++i) {
    written += x.write(written) ? 1 : 0;
    x.world.run_for(100ms);
  }
  const streams_config config;
  CHECK(written == static_cast<int>(queue_size_default + config.window_max));
  CHECK(x.world.at(writer_node).counters().busy > 0);
  CHECK(x.world.at(reader_node).counters().throttled > 0);
  CHECK(x.world.at(reader_node).counters().dropped == 0);
  std::vector<int> all;
  for (int i = 0; i < written; ++i) {
    all.push_back(i);
    x.ask();
    x.world.run_for(3s);
  }
  CHECK(x.read() == all);
  CHECK(x.write(99));
}

TEST_CASE("a reliable stream whose reader is gone ends, and says what is not confirmed",
          "[stream][STR-19]") {
  opened_stream x({}, qos_reliable);
  x.world.service.loss = 1;
  CHECK(x.write(1));
  CHECK(x.write(2));
  x.world.run_for(31s);
  CHECK_FALSE(x.world.at(writer_node).has_ended(x.writer));
  x.world.run_for(2s);
  CHECK(x.world.at(writer_node).has_ended(x.writer));
  CHECK(x.world.at(writer_node).counters().unconfirmed == 2);
  CHECK(x.world.at(writer_node).write(x.writer, bytes{1}, x.world.now).refused == failure::ended);
  CHECK_FALSE(x.world.at(writer_node).deadline());
}

TEST_CASE("a reliable stream keeps what comes before its reader has opened", "[stream][STR-14]") {
  stream_fixture world(2);
  const auto to = stream_fixture::address(1);
  const auto writer = world.take(0, world.open(0, {.destination = to, .qos = qos_reliable}));
  world.run_for(1s);
  for (std::uint8_t i = 0; i < 5; ++i)
    world.take(0, world.at(0).write(writer, bytes{i}, world.now));
  world.run_for(10s);
  const auto reader = world.take(1, world.open(1, {.destination = to}));
  world.run_for(5s);
  for (std::uint8_t i = 0; i < 5; ++i) {
    world.take(1, world.at(1).read(reader, 1));
    CHECK(std::get<read_done>(world.events.back().second).content == bytes{i});
  }
}
