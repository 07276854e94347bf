#include "stream/streams.hpp"
#include "support/catch.hpp"
#include "support/pick.hpp"

using namespace rubicon;
using namespace rubicon::stream;
using std::chrono::milliseconds;
using test::pick;

namespace {

constexpr mote_address self{island_id{3}, mote_id{17}};
constexpr instant start{2s};

streams make() {
  return streams(streams_config{.transducers = 4});
}

} // namespace

TEST_CASE("a periodic sensor stream samples on exact multiples of its period",
          "[stream][STR-07][MCK-03]") {
  auto x = make();
  const auto opened = x.open_sensor({.transducer = 2, .period = 100ms, .queue_size = 1}, start);
  REQUIRE_FALSE(opened.refused);
  std::vector<std::uint32_t> times;
  while (*x.deadline() <= start + 10s) {
    const auto due = *x.deadline();
    CHECK(x.on_time(due - 1ns).empty());
    const auto asked = pick<sample>(x.on_time(due));
    REQUIRE(asked.size() == 1);
    CHECK(asked[0].transducer == 2);
    const auto ms = static_cast<std::uint32_t>(due.time_since_epoch() / 1ms);
    const auto value = static_cast<std::int16_t>(times.size());
    CHECK(x.on_sample(asked[0].stream, {self, ms, value}).empty());
    const auto read = x.read(opened.stream, 100);
    const auto done = pick<read_done>(read.todo);
    REQUIRE(done.size() == 1);
    const auto record = decode_sensor_record(done[0].content);
    REQUIRE(record);
    CHECK(*record == sensor_record{self, ms, value});
    times.push_back(record->time_ms);
  }
  REQUIRE(times.size() == 100);
  for (std::size_t i = 0; i < times.size(); ++i)
    CHECK(times[i] == 2100 + 100 * i);
}

TEST_CASE("late sampling leaves times out instead of shifting them", "[stream][STR-07]") {
  auto x = make();
  static_cast<void>(x.open_sensor({.period = 100ms}, start));
  CHECK(pick<sample>(x.on_time(start + 105ms)).size() == 1);
  CHECK(x.deadline() == start + 200ms);
  CHECK(x.counters().missed == 0);
  CHECK(pick<sample>(x.on_time(start + 450ms)).size() == 1);
  CHECK(x.deadline() == start + 500ms);
  CHECK(x.counters().missed == 2);
}

TEST_CASE("samples wait in the queue, the oldest give way", "[stream][STR-03][STR-06]") {
  auto x = make();
  const auto id = x.open_sensor({.period = 1s, .queue_size = 2}, start).stream;
  for (std::int16_t i = 1; i <= 3; ++i) {
    static_cast<void>(x.on_time(start + 1s * i));
    static_cast<void>(x.on_sample(id, {self, 0, i}));
  }
  CHECK(x.counters().dropped == 1);
  const auto oldest = x.read(id, 12);
  CHECK(decode_sensor_record(pick<read_done>(oldest.todo).at(0).content)->value == 2);
}

TEST_CASE("an on-demand sensor stream samples when it is read and only then",
          "[stream][STR-08][MCK-03]") {
  auto x = make();
  const auto id = x.open_sensor({.transducer = 1, .kind = sampling::on_demand}, start).stream;
  CHECK_FALSE(x.deadline());
  CHECK(x.on_time(start + 1h).empty());
  const auto reading = x.read(id, 12);
  REQUIRE(pick<sample>(reading.todo).size() == 1);
  CHECK(pick<sample>(reading.todo)[0].transducer == 1);
  CHECK(pick<read_done>(reading.todo).empty());
  const auto done = pick<read_done>(x.on_sample(id, {self, 5, -7}));
  REQUIRE(done.size() == 1);
  CHECK(done[0].content == encode(sensor_record{self, 5, -7}));
  CHECK(x.on_sample(id, {self, 6, 1}).empty()); // nobody asked
  CHECK(x.counters().strays == 1);
  CHECK(pick<sample>(x.read(id, 12).todo).size() == 1);
}

TEST_CASE("a sample for a stream that is closed is ignored", "[stream][STR-05]") {
  auto x = make();
  const auto id = x.open_sensor({.kind = sampling::on_demand}, start).stream;
  CHECK_FALSE(x.read(id, 12).refused);
  CHECK(pick<read_done>(x.close(id).todo).size() == 1);
  CHECK(x.on_sample(id, {self, 5, 1}).empty());
  CHECK(x.counters().strays == 1);
}

TEST_CASE("sensor streams cannot be written", "[stream][STR-06]") {
  auto x = make();
  const auto id = x.open_sensor({}, start).stream;
  CHECK(x.write(id, bytes{1}).refused == failure::illegal_operation);
}

TEST_CASE("a sensor stream needs a transducer and a period", "[stream][STR-09][MCK-03]") {
  auto x = make();
  CHECK(x.open_sensor({.transducer = 4}, start).refused == failure::bad_argument);
  CHECK(x.open_sensor({.period = 0ms}, start).refused == failure::bad_argument);
  CHECK(x.open_sensor({.period = milliseconds(-1)}, start).refused == failure::bad_argument);
  CHECK_FALSE(x.open_sensor({.period = 1s}, start).refused);
  CHECK_FALSE(x.open_sensor({.period = 2s}, start).refused);
  CHECK_FALSE(x.open_sensor({.kind = sampling::on_demand}, start).refused);
  CHECK_FALSE(x.open_sensor({.transducer = 3, .period = 1s}, start).refused);
}

TEST_CASE("two programs read one transducer at one period, each in its own time",
          "[stream][STR-07][STR-08][MCK-03]") {
  auto x = make();
  const auto first = x.open_sensor({.transducer = 2, .period = 100ms}, start).stream;
  const auto second = x.open_sensor({.transducer = 2, .period = 100ms}, start + 30ms).stream;
  REQUIRE(first != second);
  CHECK(x.deadline() == start + 100ms);
  const auto one = x.on_time(start + 100ms);
  REQUIRE(one.size() == 1);
  CHECK(std::get<sample>(one[0]).stream == first);
  CHECK(x.deadline() == start + 130ms);
  const auto two = x.on_time(start + 130ms);
  REQUIRE(two.size() == 1);
  CHECK(std::get<sample>(two[0]).stream == second);
  CHECK(x.on_sample(second, {self, 130, 7}).empty());
  CHECK(x.on_sample(first, {self, 100, 5}).empty());
  const auto value_of = [&](descriptor which) {
    const auto got = x.read(which, sensor_record::size);
    REQUIRE(got.todo.size() == 1);
    return decode_sensor_record(std::get<read_done>(got.todo[0]).content)->value;
  };
  CHECK(value_of(first) == 5);
  CHECK(value_of(second) == 7);

  const auto asked = x.open_sensor({.kind = sampling::on_demand}, start).stream;
  const auto asked_too = x.open_sensor({.kind = sampling::on_demand}, start);
  REQUIRE_FALSE(asked_too.refused);
  CHECK_FALSE(x.read(asked, 12).todo.empty());
  CHECK_FALSE(x.close(asked).refused);
  CHECK_FALSE(x.read(asked_too.stream, 12).todo.empty());
}

TEST_CASE("the output of one stream is the input of another", "[stream][STR-22]") {
  auto x = make();
  const auto sensor = x.open_sensor({.kind = sampling::on_demand}, start).stream;
  const auto sums = x.open_local().stream;
  int sum = 0;
  for (std::int16_t i = 1; i <= 4; ++i) { // an operator: running sum of readings
    static_cast<void>(x.read(sensor, 12));
    const auto done = pick<read_done>(x.on_sample(sensor, {self, 0, i}));
    sum += decode_sensor_record(done.at(0).content)->value;
    CHECK_FALSE(x.write(sums, bytes{static_cast<std::uint8_t>(sum)}).refused);
  }
  for (const auto& expected : {bytes{1}, bytes{3}, bytes{6}, bytes{10}})
    CHECK(pick<read_done>(x.read(sums, 1).todo).at(0).content == expected);
}
