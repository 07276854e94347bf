// Whatever applications, nodes and channels do: promises are kept, and nothing leaks.
#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "core/codec.hpp"
#include "support/catch.hpp"
#include "unit/stream/fixture.hpp"

using namespace rubicon;
using namespace rubicon::stream;
using test::end_of_stream;
using test::stream_fixture;

namespace {

/// Applications that open, write, read and close at random, and keep count.
class applications {
public:
  applications(std::uint64_t seed, test::channel_service service)
      : rng_(seed, "applications"), world_(3, service, seed) {}

  void run(int steps) {
    for (int i = 0; i < steps; ++i) {
      world_.run_for(rng_.between(1ms, 400ms));
      look();
      act(rng_.below(3));
      look();
    }
    for (const auto& [key, x] : std::map(ends_)) {
      if (!x.gone)
        close(key);
    }
    world_.run_for(10min);
    look();
  }

  /// To be called after run().
  void check() {
    CHECK(world_.is_quiet());
    for (std::size_t i = 0; i < 3; ++i) {
      CHECK(world_.at(i).open_streams() == 0);
      CHECK(world_.at(i).early_channels() == 0);
      CHECK_FALSE(world_.at(i).deadline());
    }
    for (const auto& [key, x] : ends_) {
      if (key.life != world_.life(key.node))
        continue; // died: nobody waits any more
      CHECK(x.opens_done == 1);
      CHECK_FALSE(x.reading);
    }
  }

  std::uint64_t opened = 0, failed = 0, records = 0, failed_reads = 0;

private:
  struct end {
    std::uint16_t name = 0;
    int opens_done = 0;
    bool gone = false; ///< closed, or failed to open
    bool reading = false;
    std::uint32_t written = 0;
    std::optional<end_of_stream> writer{}; ///< whose records we have read
    std::optional<std::uint32_t> last{};   ///< of those records
  };

  static bytes record_of(const end_of_stream& key, std::uint32_t number) {
    byte_writer to;
    to.big(static_cast<std::uint8_t>(key.node)).big(static_cast<std::uint16_t>(key.life));
    return to.big(key.id.value).big(number).finish();
  }

  void act(std::size_t node) {
    const auto action = rng_.below(100);
    if (action < 1) {
      world_.restart(node);
      for (auto& [key, x] : ends_)
        x.gone = x.gone || key.node == node;
    } else if (action < 25) {
      open(node);
    } else if (const auto key = any_end(node)) {
      if (action < 55)
        write(*key);
      else if (action < 85)
        read(*key);
      else if (action < 92)
        close(*key);
    }
  }

  void open(std::size_t node) {
    const auto name = static_cast<std::uint16_t>(rng_.below(4));
    const bool is_local = rng_.chance(0.1);
    const bool to_self = rng_.chance(0.5);
    const auto target = to_self ? node : rng_.below(3);
    const auto x = is_local ? world_.at(node).open_local(2)
                            : world_.open(node, {.destination = stream_fixture::address(target),
                                                 .name = name,
                                                 .queue_size = 3,
                                                 .writes_to_self = rng_.chance(0.1)});
    if (x.refused)
      return;
    auto& added = ends_[{node, world_.life(node), x.stream}];
    added.name = is_local ? 100 : name;
    added.opens_done = is_local ? 1 : 0;
    world_.take(node, x);
  }

  void write(const end_of_stream& key) {
    auto& x = ends_[key];
    const auto done = world_.at(key.node).write(key.id, record_of(key, x.written), world_.now);
    if (!done.refused)
      ++x.written;
    world_.take(key.node, done);
  }

  void read(const end_of_stream& key) {
    auto& x = ends_[key];
    const auto done = world_.at(key.node).read(key.id, 100);
    if (x.reading && done.refused != failure::busy)
      FAIL("a second read was not refused");
    x.reading = x.reading || !done.refused;
    world_.take(key.node, done);
  }

  void close(const end_of_stream& key) {
    const auto done = world_.at(key.node).close(key.id);
    if (done.refused)
      FAIL("close refused: " << to_string(*done.refused));
    ends_[key].gone = true;
    world_.take(key.node, done);
  }

  std::optional<end_of_stream> any_end(std::size_t node) {
    std::vector<end_of_stream> open;
    for (const auto& [key, x] : ends_) {
      if (key.node == node && !x.gone)
        open.push_back(key);
    }
    if (open.empty())
      return std::nullopt;
    return open[rng_.below(open.size())];
  }

  void look() {
    for (const auto& [key, what] : world_.events) {
      if (!ends_.contains(key))
        FAIL("an event of a stream that was not opened");
      auto& x = ends_[key];
      if (const auto* done = std::get_if<open_done>(&what))
        look_at(x, *done);
      else
        look_at(key, x, std::get<read_done>(what));
    }
    world_.events.clear();
  }

  void look_at(end& x, const open_done& done) {
    if (++x.opens_done > 1 || done.name != x.name)
      FAIL("a second open_done, or one of another name");
    x.gone = x.gone || !done.success;
    ++(done.success ? opened : failed);
  }

  void look_at(const end_of_stream& key, end& x, const read_done& done) {
    if (!x.reading || x.opens_done != 1)
      FAIL("a read_done without read or open");
    x.reading = false;
    if (!done.success) {
      ++failed_reads;
      return;
    }
    ++records;
    byte_reader from(done.content);
    end_of_stream writer;
    writer.node = from.octet();
    writer.life = from.big<std::uint16_t>();
    writer.id = descriptor{from.big<std::uint16_t>()};
    const auto number = from.big<std::uint32_t>();
    const bool was_written = ends_.contains(writer) && ends_[writer].name == x.name &&
                             number < ends_[writer].written &&
                             done.content == record_of(writer, number);
    const bool is_first = seen_.emplace(key.node, key.life, writer, number).second;
    const auto before = x.writer.value_or(writer); // the first ones may be of the end before it
    const bool in_order =
        before.node == writer.node && before.life == writer.life &&
        (before.id < writer.id || (before == writer && (!x.last || number > *x.last)));
    if (!was_written || !is_first || !in_order)
      FAIL("node " << key.node << " read record " << number << " of node " << writer.node);
    x.writer = writer;
    x.last = number;
  }

  random_stream rng_;
  stream_fixture world_;
  std::map<end_of_stream, end> ends_;
  std::set<std::tuple<std::size_t, unsigned, end_of_stream, std::uint32_t>>
      seen_; ///< by a reader's life
};

} // namespace

TEST_CASE("under any faults each open and read is answered once, in order, without leaks",
          "[stream][STR-05][STR-19][MCK-02][MCK-07]") {
  const test::channel_service services[] = {
      {},
      {.delay_min = 1ms, .delay_max = 50ms, .loss = 0.2, .connect_loss = 0.1},
      {.delay_min = 1ms, .delay_max = 2s, .loss = 0.5, .repetition = 0.3, .connect_loss = 0.3},
  };
  for (std::size_t i = 0; i < std::size(services); ++i) {
    std::uint64_t opened = 0, failed = 0, records = 0, failed_reads = 0;
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
      INFO("service " << i << ", seed " << seed);
      applications x(seed, services[i]);
      x.run(1500);
      x.check();
      opened += x.opened;
      failed += x.failed;
      records += x.records;
      failed_reads += x.failed_reads;
    }
    INFO("service " << i << ": opened " << opened << ", failed " << failed << ", records "
                    << records << ", failed reads " << failed_reads);
    CHECK(opened > 1000);
    CHECK(failed > 100);
    CHECK(records > 1000);
    CHECK(failed_reads > 100);
  }
}
