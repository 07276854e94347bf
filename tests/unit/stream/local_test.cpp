#include "stream/streams.hpp"
#include "support/catch.hpp"
#include "support/pick.hpp"

using namespace rubicon;
using namespace rubicon::stream;
using test::pick;

namespace {

/// The record that a read has given at once; nothing when it has not.
std::optional<bytes> record_of(const answer& x) {
  const auto done = pick<read_done>(x.todo);
  if (done.empty() || !done[0].success)
    return std::nullopt;
  return done[0].content;
}

} // namespace

TEST_CASE("a local stream gives its records in order", "[stream][STR-01][STR-10][MCK-04]") {
  streams x;
  const auto opened = x.open_local();
  REQUIRE_FALSE(opened.refused);
  const auto id = opened.stream;
  CHECK(id.value > 0);
  for (std::uint8_t i = 1; i <= 3; ++i)
    CHECK_FALSE(x.write(id, bytes{i}).refused);
  for (std::uint8_t i = 1; i <= 3; ++i)
    CHECK(record_of(x.read(id, 8)) == bytes{i});
}

TEST_CASE("a full queue gives up its oldest record and counts it", "[stream][STR-03]") {
  streams x;
  const auto id = x.open_local(3).stream;
  for (std::uint8_t i = 1; i <= 5; ++i)
    CHECK_FALSE(x.write(id, bytes{i}).refused);
  CHECK(x.counters().dropped == 2);
  for (std::uint8_t i = 3; i <= 5; ++i)
    CHECK(record_of(x.read(id, 8)) == bytes{i});
  CHECK(x.read(id, 8).todo.empty());
}

TEST_CASE("a read before the write ends with the write, once", "[stream][STR-02][STR-04][MCK-07]") {
  streams x;
  const auto id = x.open_local().stream;
  const auto reading = x.read(id, 8);
  CHECK_FALSE(reading.refused);
  CHECK(reading.todo.empty());
  CHECK(x.read(id, 8).refused == failure::busy);
  const auto written = x.write(id, bytes{1, 2});
  const auto done = pick<read_done>(written.todo);
  REQUIRE(done.size() == 1);
  CHECK(done[0].stream == id);
  CHECK(done[0].success);
  CHECK(done[0].content == bytes{1, 2});
  CHECK(x.write(id, bytes{3}).todo.empty());
  CHECK(record_of(x.read(id, 8)) == bytes{3});
}

TEST_CASE("a read shows at most as many octets as it asks for, of one record",
          "[stream][A-55][MCK-07]") {
  streams x;
  const auto id = x.open_local().stream;
  CHECK_FALSE(x.write(id, bytes{1, 2, 3, 4, 5}).refused);
  CHECK_FALSE(x.write(id, bytes{6}).refused);
  CHECK(x.read(id, 0).refused == failure::bad_argument);
  CHECK(record_of(x.read(id, 2)) == bytes{1, 2});
  CHECK(x.counters().excess_octets == 3);
  CHECK(record_of(x.read(id, 2)) == bytes{6});
  CHECK(x.counters().excess_octets == 3);
}

TEST_CASE("a record without octets is a record", "[stream]") {
  streams x;
  const auto id = x.open_local().stream;
  CHECK_FALSE(x.write(id, {}).refused);
  CHECK(record_of(x.read(id, 1)) == bytes{});
}

TEST_CASE("a record longer than the limit is refused", "[stream][MCK-08]") {
  streams x(streams_config{.record_max = 10});
  const auto id = x.open_local().stream;
  CHECK_FALSE(x.write(id, bytes(10)).refused);
  CHECK(x.write(id, bytes(11)).refused == failure::too_long);
}

TEST_CASE("closing ends a pending read and makes the descriptor stale",
          "[stream][STR-05][MCK-05]") {
  streams x;
  const auto id = x.open_local().stream;
  CHECK_FALSE(x.read(id, 8).refused);
  const auto closed = x.close(id);
  CHECK_FALSE(closed.refused);
  const auto done = pick<read_done>(closed.todo);
  REQUIRE(done.size() == 1);
  CHECK(done[0].stream == id);
  CHECK_FALSE(done[0].success);
  CHECK(x.close(id).refused == failure::bad_descriptor);
  const auto next = x.open_local().stream;
  CHECK(next != id);
  CHECK(x.read(id, 8).refused == failure::bad_descriptor);
  CHECK(x.write(id, {}).refused == failure::bad_descriptor);
  CHECK(x.close(id).refused == failure::bad_descriptor);
  CHECK(x.open_streams() == 1);
}

TEST_CASE("the table of streams is limited", "[stream][STR-20][MCK-01]") {
  streams x(streams_config{.transducers = 1});
  std::vector<descriptor> all;
  for (int i = 0; i < 8; ++i)
    all.push_back(x.open_local().stream);
  const mote_address self{island_id{1}, mote_id{2}};
  CHECK(x.open_local().refused == failure::no_room);
  CHECK(x.open_sensor({}, {}).refused == failure::no_room);
  CHECK(x.open_remote(self, {.destination = self}, {}).refused == failure::no_room);
  CHECK_FALSE(x.close(all[3]).refused);
  CHECK_FALSE(x.open_local().refused);
  CHECK(x.open_local().refused == failure::no_room);
}

TEST_CASE("queues have a size, and one that is bounded", "[stream]") {
  streams x(streams_config{.queue_max = 4});
  CHECK(x.open_local(0).refused == failure::bad_argument);
  CHECK(x.open_local(5).refused == failure::bad_argument);
  CHECK_FALSE(x.open_local(4).refused);
}

TEST_CASE("descriptors stay in what D1.1 can return, and skip those in use", "[stream][STR-05]") {
  streams x;
  const auto kept = x.open_local().stream;
  auto last = kept;
  for (int i = 0; i < 33000; ++i) {
    const auto id = x.open_local().stream;
    const bool is_sound = id.value >= 1 && id.value <= 32767 && id != kept && id != last;
    if (!is_sound)
      FAIL("descriptor " << id.value << " after " << last.value);
    static_cast<void>(x.close(id));
    last = id;
  }
  CHECK_FALSE(x.write(kept, {}).refused);
}

TEST_CASE("the memory of the default tables fits a mote", "[stream][SMP-30]") {
  CHECK(streams().footprint() == 5 * (30 + 12 + 102) + 2 * (13 + 102));
  CHECK(streams(streams_config{.streams_max = 16}).footprint() > streams().footprint());
}
