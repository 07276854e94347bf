// How well the root of an island knows the time that peers share, over a line with queues (CLK-08).
#include <algorithm>
#include <optional>

#include "core/numbers/random.hpp"
#include "network/clock/clock_sync.hpp"
#include "network/clock/time_reference.hpp"
#include "support/catch.hpp"
#include "support/seeds.hpp"

namespace rubicon::network {

namespace {

/// A sink whose crystal is off, a serial line of 57600 baud, and a gateway that answers at once.
struct fixture {
  double ppm = 0;
  duration ahead = 1'000'000'000s; ///< network time minus real time
  duration way = 6ms;              ///< of question and of answer
  double busy = 0;                 ///< chance that either waits in a queue,
  duration queue_max = 40ms;       ///< so long at most,
  bool is_said = false;            ///< which its end says
  bool answers = true;
  duration now{};
  random_stream rng{1};
  time_reference reference;
  std::optional<std::uint16_t> question = {};
  duration there{}; ///< when the question is there,
  duration back{};  ///< and its answer here,
  duration held{};  ///< which left so late

  explicit fixture(double off_ppm, std::uint64_t seed = 1)
      : ppm(off_ppm), rng(seed), reference({}, own()) {}

  [[nodiscard]] instant own() const {
    return instant(
        1h + now +
        duration(static_cast<duration::rep>(static_cast<double>(now.count()) * ppm * 1e-6)));
  }

  duration queue() { return rng.chance(busy) ? rng.between(0s, queue_max) : 0s; }

  void run_for(duration length) {
    for (const auto end = now + length; now < end; now += 100us) {
      if (question && now >= back) {
        reference.on_answer(*question, there + ahead, own(), is_said ? held : 0s);
        question.reset();
      }
      if (const auto number = reference.on_time(own()); number && answers) {
        question = number;
        const auto wait = queue();
        if (is_said)
          reference.on_delayed(wait);
        there = now + wait + way;
        held = queue();
        back = there + held + way;
      }
    }
  }

  [[nodiscard]] duration error() const {
    return std::chrono::abs(*reference.at(own()) - (now + ahead));
  }
};

} // namespace

TEST_CASE("a root knows the time of its gateway from the first answer on", "[network][CLK-08]") {
  fixture x(50);
  CHECK_FALSE(x.reference.at(x.own()));
  x.run_for(1100ms);
  REQUIRE(x.reference.at(x.own()));
  CHECK(x.error() < 200us);
  CHECK(x.reference.counters().good == 1);
}

TEST_CASE("a line that is never free does not matter if its ends say so", "[network][CLK-08]") {
  const auto seed = static_cast<std::uint64_t>(GENERATE(range(1, 11)));
  fixture x(80, seed);
  x.busy = 1;
  x.queue_max = 400ms;
  x.is_said = true;
  x.run_for(5s);
  CHECK(x.error() < 300us);
  x.run_for(5min);
  CHECK(x.error() < 100us);
  CHECK(x.reference.counters().slow == 0);
}

TEST_CASE("an answer that was held longer than it took shows nothing", "[network][CLK-08]") {
  fixture x(0);
  x.run_for(1s + 200us);
  REQUIRE(x.question);
  x.reference.on_answer(*x.question, x.ahead + 1s, x.own(), 1h);
  CHECK_FALSE(x.reference.at(x.own()));
  CHECK(x.reference.counters().slow == 1);
}

TEST_CASE("it asks every second at first, then every ten", "[network][CLK-08]") {
  fixture x(0);
  x.run_for(4500ms);
  CHECK(x.reference.counters().asked == 4);
  x.run_for(9s);
  CHECK(x.reference.counters().asked == 4);
  x.run_for(90s);
  CHECK(x.reference.counters().asked == 13);
  CHECK(x.reference.counters().good == 13);
}

TEST_CASE("what waits in queues does not shift the time by more than a millisecond",
          "[network][CLK-08]") {
  for (std::uint64_t seed = 1; seed <= test::seeds(20); ++seed) {
    CAPTURE(seed);
    fixture x(random_stream(seed).unit() * 100 - 50, seed);
    x.busy = 0.4;
    x.run_for(60s);
    duration worst{};
    for (int i = 0; i < 100; ++i) {
      x.run_for(2s);
      worst = std::max(worst, x.error());
    }
    CHECK(worst < 2ms);
    CHECK(x.reference.counters().slow > 0);
    CHECK(std::abs(x.reference.drift().value_or(0) * 1e6 + x.ppm) < 30);
    CHECK(x.reference.counters().leaps == 0);
  }
}

TEST_CASE("the time goes on at the pace that was learnt while no answer comes",
          "[network][CLK-08]") {
  fixture x(-50);
  x.run_for(60s);
  const auto asked = x.reference.counters().asked;
  x.answers = false;
  x.run_for(10min);
  CHECK(x.error() < 500us);
  CHECK(x.reference.counters().asked <= asked + 60); // no more often than with answers
  x.answers = true;
  x.run_for(30s);
  CHECK(x.error() < 500us);
  CHECK(x.reference.counters().leaps == 0);
}

TEST_CASE("one wrong answer is ignored, a clock that was set is followed", "[network][CLK-08]") {
  fixture x(20);
  x.run_for(60s);
  const auto before = x.ahead;
  x.ahead += 5s;
  const auto good = x.reference.counters().good;
  while (x.reference.counters().doubtful == 0)
    x.run_for(10ms);
  x.ahead = before;
  x.run_for(30s);
  CHECK(x.error() < 500us);
  CHECK(x.reference.counters().leaps == 0);
  CHECK(x.reference.counters().good > good);

  x.ahead -= 5s;
  x.run_for(13s);
  CHECK(x.error() < 500us);
  CHECK(x.reference.counters().leaps == 1);
}

TEST_CASE("wrong answers with good ones between are no leap", "[network][CLK-08]") {
  fixture x(20);
  x.run_for(60s);
  const auto before = x.ahead;
  for (std::uint64_t i = 1; i <= 3; ++i) {
    x.ahead = before + 5s;
    for (int step = 0; step < 1200 && x.reference.counters().doubtful < i; ++step)
      x.run_for(10ms);
    CHECK(x.reference.counters().doubtful == i);
    x.ahead = before;
    x.run_for(30s);
    CHECK(x.error() < 500us);
  }
  CHECK(x.reference.counters().leaps == 0);
}

TEST_CASE("answers to other questions, and those that come late, show nothing",
          "[network][CLK-08]") {
  time_reference x({}, instant{});
  x.on_answer(1, 1000s, instant(10ms)); // nothing was asked
  CHECK(x.on_time(x.deadline()) == 1);
  x.on_answer(2, 1000s, instant(1001ms));
  CHECK(x.counters().strays == 2);
  CHECK_FALSE(x.at(instant(2s)));
  x.on_answer(1, 1000s, instant(2500ms));
  CHECK(x.counters().slow == 1);
  CHECK_FALSE(x.at(instant(3s)));
  x.on_answer(1, 1000s, instant(2600ms)); // again
  CHECK(x.counters().strays == 3);
}

TEST_CASE("a line that is always slow is asked a little more often, not all the time",
          "[network][CLK-08]") {
  fixture x(0);
  x.way = 600ms; // there and back is longer than an answer may take
  x.run_for(190s);
  CHECK(x.reference.counters().answered == x.reference.counters().slow);
  // Questions of 2.2 s each, and after every five of them a gap of 10 s.
  CHECK(x.reference.counters().asked > 40);
  CHECK(x.reference.counters().asked < 60);
}

TEST_CASE("a line that has become slower for good is believed again", "[network][CLK-08]") {
  fixture x(0);
  x.run_for(60s);
  x.way = 30ms;
  x.run_for(150s);
  const auto good = x.reference.counters().good;
  x.run_for(60s);
  CHECK(x.reference.counters().good >= good + 5);
  CHECK(x.error() < 500us);
}

namespace {

/// A root and a mote that hears it, both on perfect crystals.
struct pair {
  instant now;
  clock_sync root;
  clock_sync mote;

  pair() {
    clock_sync_config config;
    config.self = mote_id{2};
    mote = clock_sync(config, now);
    config.self = mote_id{1};
    config.is_root = true;
    root = clock_sync(config, now);
  }

  /// @returns rounds that the root has begun
  int run_for(duration length) {
    int rounds = 0;
    for (const auto end = now + length; now < end; now += 10ms) {
      if (!root.on_time(now))
        continue;
      ++rounds;
      byte_writer to;
      write(to, *root.stamp(now));
      const auto octets = to.finish();
      byte_reader from(octets);
      mote.on_stamp(read_clock_stamp(from), now);
    }
    return rounds;
  }
};

} // namespace

TEST_CASE("motes know the time that the root knows, with the first beacon",
          "[network][CLK-08][IF-06]") {
  pair x;
  x.root.set_network_time(1'000'000'000s + 2s, 0, instant(2s));
  CHECK_FALSE(x.mote.time().network_time(x.now));
  x.run_for(3100ms);
  REQUIRE(x.mote.time().network_time(x.now));
  CHECK(*x.mote.time().network_time(x.now) == 1'000'000'000s + x.now.time_since_epoch());
  CHECK(*x.root.time().network_time(x.now) == *x.mote.time().network_time(x.now));
}

TEST_CASE("without a reference motes know the island's time alone", "[network][CLK-08]") {
  pair x;
  x.run_for(1min);
  CHECK(x.mote.time().synchronised());
  CHECK_FALSE(x.mote.time().network_time(x.now));
}

TEST_CASE("a leap of the network time is sent at once", "[network][CLK-05][CLK-08]") {
  pair x;
  x.root.set_network_time(1000s, 0, x.now);
  x.run_for(33s);
  const auto island = x.mote.time().at(x.now) - island_time{};
  const auto tick = x.mote.time().tick(x.now);
  x.root.set_network_time(1000s + x.now.time_since_epoch() + 800us, 0, x.now);
  CHECK(x.run_for(1s) == 0); // soon enough with the next round
  x.root.set_network_time(1000s + x.now.time_since_epoch() - 5s, 0, x.now);
  CHECK(x.run_for(100ms) == 1);
  CHECK(*x.mote.time().network_time(x.now) == 995s + x.now.time_since_epoch());
  CHECK(x.mote.time().at(x.now) - island_time{} - island == 1100ms);
  const auto after = x.mote.time().tick(x.now);
  CHECK(after->first == tick->first - 10 + 2); // 5 s back, 1.1 s on
  CHECK((after->from - tick->from) % tick->period == 0us);
  CHECK(x.mote.time().steps() == 0);
}

TEST_CASE("a root that restarts goes on with the network time that its motes know",
          "[network][CLK-08]") {
  pair x;
  x.root.set_network_time(1000s, 0, x.now);
  x.run_for(60s);
  clock_sync_config config;
  config.self = mote_id{1};
  config.is_root = true;
  x.root = clock_sync(config, x.now);
  x.root.on_stamp(*x.mote.stamp(x.now), x.now);
  x.run_for(20s);
  REQUIRE(x.root.time().network_time(x.now));
  CHECK(std::chrono::abs(*x.root.time().network_time(x.now) - (1000s + x.now.time_since_epoch())) <
        1ms);
  CHECK(std::chrono::abs(*x.mote.time().network_time(x.now) - (1000s + x.now.time_since_epoch())) <
        1ms);
}

TEST_CASE("a stamp with the network time keeps its layout", "[network][CLK-08][golden]") {
  clock_stamp x;
  x.root = mote_id{1};
  x.tick.from = island_time(std::chrono::microseconds(0x010203040506));
  x.network = network_line{std::chrono::microseconds(0x1122334455667), -12.34e-6};
  byte_writer to;
  write(to, x);
  const auto octets = to.finish();
  REQUIRE(octets.size() == clock_stamp_size + network_line_size);
  CHECK(to_hex(byte_view(octets).subspan(19)) == "81020304050601f4000001122334455667fb2e");
  byte_reader from(octets);
  const auto again = read_clock_stamp(from);
  CHECK(again.network->ahead == x.network->ahead);
  CHECK(again.network->rate == Approx(-12.34e-6));
  CHECK(from.ok());
}

TEST_CASE("an absurd network time is not believed", "[network][CLK-08]") {
  pair x;
  x.root.set_network_time(1'000'000'000s + 2s, 0, instant(2s));
  x.run_for(5s);
  CHECK(x.mote.time().network_time(x.now));
  auto stamp = *x.root.stamp(x.now);
  for (const auto absurd : {std::chrono::microseconds::max(), std::chrono::microseconds::min()}) {
    ++stamp.sequence;
    stamp.network = network_line{absurd, 0};
    CHECK(x.mote.on_stamp(stamp, x.now) == stamp_value::news);
    CHECK_FALSE(x.mote.time().network_time(x.now));
  }
}

} // namespace rubicon::network
