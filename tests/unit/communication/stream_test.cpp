// Remote streams between motes and PCs, wherever they are (PAR-02).
#include <algorithm>

#include "support/catch.hpp"
#include "support/placements_fixture.hpp"

using namespace rubicon;
using test::placement;
using test::placements_fixture;
using test::recorder;

namespace {

constexpr std::uint16_t name = 77;

/// Both ends call the same: the read end passes itself (STR-11).
communication::status open(placements_fixture& world, mote_address where, recorder& program,
                           mote_address destination) {
  return world.act(where, [&] {
    return program.layer->open_remote(
        static_cast<communication::island_octet>(destination.island.value), destination.mote.value,
        name, 100, 0);
  });
}

struct stream_fixture {
  explicit stream_fixture(const placement& placed, test::placements_config config = {})
      : x(placed), world(config) {
    REQUIRE(world.settle());
    attach(world, x, writer, reader);
    reader.reads_all = true;
  }

  void open_both(bool reader_first) {
    if (reader_first)
      REQUIRE(open(world, x.to, reader, x.to) == communication::SUCCESS);
    else
      REQUIRE(open(world, x.from, writer, x.to) == communication::SUCCESS);
    world.run_for(3s);
    if (reader_first)
      REQUIRE(open(world, x.from, writer, x.to) == communication::SUCCESS);
    else
      REQUIRE(open(world, x.to, reader, x.to) == communication::SUCCESS);
    world.run_for(3s);
    REQUIRE(writer.openings.size() == 1);
    REQUIRE(reader.openings.size() == 1);
    REQUIRE(writer.openings[0].success);
    REQUIRE(reader.openings[0].success);
    CHECK(writer.openings[0].name == name);
    CHECK(reader.openings[0].name == name);
  }

  int write(const bytes& record) {
    return world.act(x.from, [&] { return writer.layer->write(source(), record); });
  }

  [[nodiscard]] int source() const { return writer.openings[0].descriptor; }
  [[nodiscard]] int drain() const { return reader.openings[0].descriptor; }

  recorder writer;
  recorder reader;
  placement x;
  placements_fixture world;
};

} // namespace

TEST_CASE("records come in order over a stream opened in either order, in all placements",
          "[communication][PAR-02][PAR-05][GEN-09][STR-11][STR-12][STR-13][STR-14][STR-16][STR-18]"
          "[MCK-01][MCK-02][MCK-08]") {
  const auto& placed =
      test::placements[GENERATE(range(0U, test::placements_max, test::placements_step))];
  const bool reader_first = GENERATE(true, false);
  CAPTURE(placed.name, reader_first);
  stream_fixture s(placed);
  s.open_both(reader_first);
  for (std::uint8_t i = 0; i < 20; ++i) {
    CHECK(s.write(bytes(i % 12U + 1, i)) == i % 12 + 1);
    s.world.run_for(200ms);
  }
  s.world.run_for(3s);
  REQUIRE(s.reader.readings.size() == 20);
  for (std::uint8_t i = 0; i < 20; ++i) {
    CHECK(s.reader.readings[i].success);
    CHECK(s.reader.readings[i].descriptor == s.drain());
    CHECK(s.reader.readings[i].record == bytes(i % 12U + 1, i));
  }
  CHECK(s.write(bytes(17)) == -1); // the default buffer size is 16
  const auto& counters = s.world.layer_of(s.x.to).ports().streams.core().counters();
  CHECK(counters.stored == 20);
  CHECK(counters.lost == 0);
  CHECK(counters.repeated == 0);
}

TEST_CASE("who opens a stream learns how old a record can be, and none is older, in all placements",
          "[communication][IF-05][PAR-05]") {
  const auto& placed =
      test::placements[GENERATE(range(0U, test::placements_max, test::placements_step))];
  CAPTURE(placed.name);
  stream_fixture s(placed);
  CHECK(!s.writer.layer->latency_bound(1));
  s.open_both(false);
  const auto bound = s.reader.layer->latency_bound(s.drain());
  REQUIRE(bound);
  CHECK(s.writer.layer->latency_bound(s.source()).has_value());
  CHECK(*bound <= 12s); // of the longest paths
  duration oldest{};
  for (std::size_t i = 1; i <= 1000; ++i) {
    CHECK(s.write(bytes{1}) == 1);
    duration age{};
    for (; s.reader.readings.size() < i && age <= *bound; age += 20ms)
      s.world.run_for(20ms);
    REQUIRE(s.reader.readings.size() == i);
    oldest = std::max(oldest, age);
    s.world.run_for(100ms);
  }
  CHECK(oldest <= *bound);
  CHECK(oldest >= 20ms);
}

TEST_CASE("the wrong end neither reads nor writes, in all placements",
          "[communication][STR-17][MCK-06][MCK-08]") {
  const auto& placed =
      test::placements[GENERATE(range(0U, test::placements_max, test::placements_step))];
  CAPTURE(placed.name);
  stream_fixture s(placed);
  s.open_both(true);
  CHECK(s.world.act(s.x.from, [&] { return s.writer.layer->read(s.source(), 10); }) ==
        communication::FAIL);
  CHECK(s.world.act(s.x.to, [&] { return s.reader.layer->write(s.drain(), bytes{1}); }) == -1);
  CHECK(open(s.world, s.x.from, s.writer, s.x.to) == communication::FAIL); // already open
  CHECK(open(s.world, s.x.to, s.reader, s.x.to) == communication::FAIL);
}

TEST_CASE("the reader hears that the writer has closed, in all placements",
          "[communication][STR-05][MCK-05][MCK-07]") {
  const auto& placed =
      test::placements[GENERATE(range(0U, test::placements_max, test::placements_step))];
  CAPTURE(placed.name);
  stream_fixture s(placed);
  s.open_both(true);
  REQUIRE(s.write(bytes{1}) == 1);
  s.world.run_for(2s);
  REQUIRE(s.reader.readings.size() == 1);
  const auto close = [&] { return s.writer.layer->close(s.source()); };
  CHECK(s.world.act(s.x.from, close) == communication::SUCCESS);
  CHECK(s.world.act(s.x.from, close) == communication::FAIL);
  CHECK(s.write(bytes{2}) == -1);
  s.world.run_for(3s);
  REQUIRE(s.reader.readings.size() == 2);
  CHECK_FALSE(s.reader.readings[1].success);
  const auto read = [&] { return s.reader.layer->read(s.drain(), 10); };
  CHECK(s.world.act(s.x.to, read) == communication::FAIL);
  CHECK(s.world.act(s.x.to, [&] { return s.reader.layer->close(s.drain()); }) ==
        communication::SUCCESS);
  CHECK(s.world.layer_of(s.x.from).ports().streams.core().open_streams() == 0);
  CHECK(s.world.layer_of(s.x.to).ports().streams.core().open_streams() == 0);
}

TEST_CASE("the writer hears that the reader has closed, in all placements",
          "[communication][STR-05][MCK-05]") {
  const auto& placed =
      test::placements[GENERATE(range(0U, test::placements_max, test::placements_step))];
  CAPTURE(placed.name);
  stream_fixture s(placed);
  s.open_both(false);
  CHECK(s.world.act(s.x.to, [&] { return s.reader.layer->close(s.drain()); }) ==
        communication::SUCCESS);
  REQUIRE(s.reader.readings.size() == 1); // the pending one
  CHECK_FALSE(s.reader.readings[0].success);
  s.world.run_for(3s);
  CHECK(s.write(bytes{1}) == -1);
  CHECK(s.world.layer_of(s.x.to).ports().streams.core().open_streams() == 0);
}

TEST_CASE(
    "opening towards an absent node fails after the timeout and leaves nothing, in all placements",
    "[communication][STR-19][MCK-02]") {
  const auto& placed =
      test::placements[GENERATE(range(0U, test::placements_max, test::placements_step))];
  CAPTURE(placed.name);
  stream_fixture s(placed);
  s.world.kill(s.x.to);
  REQUIRE(open(s.world, s.x.from, s.writer, s.x.to) == communication::SUCCESS);
  s.world.run_for(35s);
  REQUIRE(s.writer.openings.size() == 1);
  CHECK_FALSE(s.writer.openings[0].success);
  s.world.run_for(10s);
  CHECK(s.writer.openings.size() == 1);
  CHECK(s.world.layer_of(s.x.from).ports().streams.core().open_streams() == 0);
  CHECK(s.world.layer_of(s.x.from).ports().channels.tunnels().size() == 0);
}

TEST_CASE("a reader without a writer gives up, as does a writer that is closed, in all "
          "placements",
          "[communication][STR-19]") {
  const auto& placed =
      test::placements[GENERATE(range(0U, test::placements_max, test::placements_step))];
  CAPTURE(placed.name);
  stream_fixture s(placed);
  REQUIRE(open(s.world, s.x.to, s.reader, s.x.to) == communication::SUCCESS);
  REQUIRE(open(s.world, s.x.from, s.writer, s.x.to) == communication::SUCCESS);
  s.world.kill(s.x.from);
  s.world.run_for(160s);
  const auto& layer = s.world.layer_of(s.x.to);
  REQUIRE(s.reader.openings.size() == 1);
  if (s.reader.openings[0].success) { // the write end got as far as that
    REQUIRE(layer.ports().streams.core().open_streams() == 1);
    CHECK(s.world.act(s.x.to, [&] { return s.reader.layer->close(s.drain()); }) ==
          communication::SUCCESS);
  }
  CHECK(layer.ports().streams.core().open_streams() == 0);
  CHECK(layer.ports().streams.core().early_channels() == 0);
  CHECK(layer.ports().channels.tunnels().size() == 0);
}

TEST_CASE("over lossy routes records come in order and once, and those lost are counted, in all "
          "placements",
          "[communication][STR-16][STR-18][PAR-02]") {
  const auto& placed =
      test::placements[GENERATE(range(0U, test::placements_max, test::placements_step))];
  CAPTURE(placed.name);
  stream_fixture s(placed, {.frame_delivery = 0.85, .message_delivery = 0.8, .seed = 3});
  REQUIRE(open(s.world, s.x.to, s.reader, s.x.to) == communication::SUCCESS);
  REQUIRE(open(s.world, s.x.from, s.writer, s.x.to) == communication::SUCCESS);
  REQUIRE(s.world.run_until([&] { return !s.writer.openings.empty(); }, 30s));
  REQUIRE(s.writer.openings[0].success);
  REQUIRE(s.reader.openings.size() == 1);
  for (std::uint8_t i = 0; i < 100; ++i) {
    REQUIRE(s.write({i}) == 1);
    s.world.run_for(500ms);
  }
  s.world.run_for(5s);
  const auto& counters = s.world.layer_of(s.x.to).ports().streams.core().counters();
  std::vector<std::uint8_t> records;
  for (const auto& each : s.reader.readings) {
    REQUIRE(each.success);
    records.push_back(each.record.at(0));
  }
  CHECK(std::ranges::is_sorted(records));
  CHECK(std::ranges::adjacent_find(records) == records.end());
  CHECK(records.size() > 50);
  CHECK(records.size() == counters.stored);
  CHECK(counters.lost == records.back() + 1U - records.size());
}

TEST_CASE("a PC that is started again loses its streams and opens them anew",
          "[communication][STR-19][STR-05]") {
  recorder writer;
  recorder reader;
  recorder next_reader;
  placements_fixture world;
  const placement x{"", {island_id{1}, mote_id{4}}, {island_id{20}, no_mote}};
  REQUIRE(world.settle());
  world.attach(x.from, writer);
  world.attach(x.to, reader);
  REQUIRE(open(world, x.to, reader, x.to) == communication::SUCCESS);
  REQUIRE(open(world, x.from, writer, x.to) == communication::SUCCESS);
  world.run_for(5s);
  REQUIRE(writer.openings.size() == 1);
  REQUIRE(reader.openings.size() == 1);
  const auto write = [&](std::size_t opening) {
    return world.act(
        x.from, [&] { return writer.layer->write(writer.openings[opening].descriptor, bytes{9}); });
  };
  world.kill(x.to);
  world.start_pc(peer_id{20});
  world.attach(x.to, next_reader);
  next_reader.reads_all = true;
  CHECK(write(0) == 1); // it does not know yet
  world.run_for(2s);
  CHECK(write(0) == -1);
  CHECK(world.act(x.from, [&] { return writer.layer->close(writer.openings[0].descriptor); }) ==
        communication::SUCCESS);
  REQUIRE(open(world, x.to, next_reader, x.to) == communication::SUCCESS);
  REQUIRE(open(world, x.from, writer, x.to) == communication::SUCCESS);
  world.run_for(5s);
  REQUIRE(writer.openings.size() == 2);
  REQUIRE(writer.openings[1].success);
  CHECK(write(1) == 1);
  world.run_for(2s);
  REQUIRE(next_reader.readings.size() == 1);
  CHECK(next_reader.readings[0].record == bytes{9});
}
