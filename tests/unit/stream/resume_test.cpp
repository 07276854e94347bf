// Streams that are opened again by the same ends: what was in flight when the channel broke.
#include "support/catch.hpp"
#include "unit/stream/fixture.hpp"

using namespace rubicon;
using namespace rubicon::stream;
using test::reader_node;
using test::stream_fixture;
using test::writer_node;

namespace {

/// Programs at both ends that open stream 7 again whenever it ends; a record counts those written
/// before.
class resumed_stream {
public:
  explicit resumed_stream(test::channel_service service = {}, std::uint64_t seed = 1)
      : world(2, service, seed) {
    open();
  }

  void open() {
    for (const auto node : {reader_node, writer_node}) {
      if (ends_[node].value != 0)
        world.take(node, world.at(node).close(ends_[node]));
      ends_[node] = world.take(
          node, world.open(node, {.destination = stream_fixture::address(reader_node), .name = 7}));
    }
    world.run_for(5s); // four times the longest delay, and then some
    read();
  }

  /// @returns whether the stream took it
  bool write() {
    const bytes record{static_cast<std::uint8_t>(next_ >> 8U),
                       static_cast<std::uint8_t>(next_),
                       1,
                       2,
                       3,
                       4,
                       5,
                       6,
                       7,
                       8,
                       9,
                       10};
    const auto done = world.at(writer_node).write(ends_[writer_node], record, world.now);
    if (!done.refused)
      ++next_;
    world.take(writer_node, done);
    return !done.refused;
  }

  void write_for(duration x) {
    for (const auto end = world.now + x; world.now < end && write();) {
      world.run_for(1s);
      read();
    }
  }

  void read() {
    for (;;) {
      const auto done = world.at(reader_node).read(ends_[reader_node], 100);
      if (done.refused)
        return;
      world.take(reader_node, done);
    }
  }

  /// What the reader's program has got, in order.
  [[nodiscard]] std::vector<std::uint16_t> got() const {
    std::vector<std::uint16_t> all;
    for (const auto& [where, what] : world.events) {
      const auto* x = std::get_if<read_done>(&what);
      if (x != nullptr && x->success)
        all.push_back(static_cast<std::uint16_t>(x->content.at(0) << 8U | x->content.at(1)));
    }
    return all;
  }

  [[nodiscard]] std::uint16_t written() const { return next_; }

  stream_fixture world;

private:
  descriptor ends_[2]{};
  std::uint16_t next_ = 0;
};

std::vector<std::uint16_t> numbers(std::uint16_t first, std::uint16_t end) {
  std::vector<std::uint16_t> all;
  for (; first < end; ++first)
    all.push_back(first);
  return all;
}

} // namespace

TEST_CASE("records on their way into a broken channel arrive when the stream is open again",
          "[stream][NET-09][STR-16]") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    CAPTURE(seed);
    random_stream rng(seed, "cuts");
    resumed_stream x({.delay_min = 5ms, .delay_max = 900ms, .repetition = 0.2}, seed);
    for (int cuts = 0; cuts < 50; ++cuts) {
      x.write_for(rng.between(1s, 20s));
      x.world.cut(rng.between(1ms, 5s));
      x.write_for(1min); // until it hears of it
      x.open();
    }
    x.world.run_for(10s);
    x.read();
    CHECK(x.got() == numbers(0, x.written()));
    CHECK(x.world.at(reader_node).counters().lost == 0);
    CHECK(x.world.at(reader_node).counters().resumed > 0);
  }
}

TEST_CASE("records that the write end no longer has are counted lost", "[stream]") {
  resumed_stream x;
  x.write_for(10s);
  x.world.cut(20s);
  x.write_for(1min);
  x.open();
  x.write_for(5s);
  REQUIRE(x.written() == 10 + 20 + 5);
  auto expected = numbers(0, 10);
  for (const auto each : numbers(30 - 102 / 13, 35))
    expected.push_back(each);
  CHECK(x.got() == expected);
  CHECK(x.world.at(reader_node).counters().lost == 20 - 102 / 13);
  CHECK(x.world.at(reader_node).counters().resumed == 102 / 13);
}

TEST_CASE("a stream that was left for long begins with new records", "[stream]") {
  resumed_stream x;
  x.write_for(10s);
  x.world.cut(3s);
  x.write_for(1min);
  x.world.run_for(5min);
  x.open();
  x.write_for(5s);
  REQUIRE(x.written() == 18);
  CHECK(x.got().size() == 15);
  CHECK(x.world.at(reader_node).counters().lost == 3);
}

TEST_CASE("an end that has started anew begins with the channel", "[stream]") {
  const auto node = GENERATE(writer_node, reader_node);
  CAPTURE(node);
  resumed_stream x;
  x.write_for(10s);
  x.world.restart(node);
  x.world.run_for(1s);
  x.open();
  x.write_for(10s);
  CHECK(x.got() == numbers(0, 20));
  CHECK(x.world.at(reader_node).counters().lost == 0);
  CHECK(x.world.at(reader_node).counters().resumed == 0);
}
