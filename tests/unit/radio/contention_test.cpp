#include <cstdint>
#include <optional>
#include <variant>

#include "support/catch.hpp"
#include "unit/radio/fixture.hpp"

using namespace rubicon;
using namespace rubicon::radio;
using test::channel_with;
using test::radio_fixture;

namespace {

/// Two senders on either side of a receiver, each with a frame every 20 to 40 ms.
copy_counters two_senders(double apart_m) {
  radio_fixture x(channel_with([](auto& c) { c.retries_max = 0; }));
  const auto a = x.add(1, 0);
  const auto b = x.add(2, apart_m);
  const auto middle = x.add(3, apart_m / 2);
  random_stream rng(11);
  instant next_a;
  instant next_b;
  while (x.now < instant(60s)) {
    auto& next = next_a < next_b ? next_a : next_b;
    x.run_until(next);
    x.send(&next == &next_a ? a : b, 0, 3, 28);
    next += rng.between(20ms, 40ms);
  }
  return x.channel.counts().by(middle).copies;
}

} // namespace

TEST_CASE("a saturated sender reaches the arithmetic of the standard", "[radio][channel][NET-15]") {
  struct rate {
    std::size_t payload;
    bool ack;
    double period_us;
  };
  // mean back-off 1120, assessment 128, turnaround 192, frame, [turnaround, ack,] space
  for (const auto& [size, ack, period_us] :
       {rate{28, false, 1120 + 128 + 192 + 1504 + 640},
        rate{28, true, 1120 + 128 + 192 + 1504 + 192 + 352 + 640},
        rate{5, false, 1120 + 128 + 192 + 768 + 192}, // 18 octets: the longest with a short space
        rate{6, false, 1120 + 128 + 192 + 800 + 640},
        rate{114, false, 1120 + 128 + 192 + 4256 + 640}}) {
    INFO(size << " octets, ack " << ack);
    radio_fixture x;
    const auto a = x.add(1, 0);
    auto quick = *find_platform("iris");
    quick.service_time = 100us;
    x.add(2, 10, 1, &quick);
    const auto sent = x.saturate({a}, 2, size, ack, 20s);
    CHECK(static_cast<double>(sent) == Approx(20e6 / period_us).epsilon(0.02));
    CHECK(x.channel.counts().by_all().copies.of(copy_outcome::overflow) == 0);
  }
}

TEST_CASE("no radio begins to send within an assessment and a turnaround of another's frame",
          "[radio][channel][NET-15]") {
  radio_fixture x;
  const auto a = x.add(1, 0);
  const auto b = x.add(2, 10);
  x.saturate({a, b}, 0xffff, 28, false, 20s);
  instant last_end;
  std::optional<radio_index> last;
  int changes = 0;
  for (const auto& [at, what] : x.log) {
    const auto* ended = std::get_if<done>(&what);
    if (ended == nullptr || ended->status != send_status::sent)
      continue;
    const auto begun = at - air_time(41);
    if (last && *last != ended->radio && begun >= last_end) { // else both began at once
      CHECK(begun >= last_end + 128us + 192us);
      ++changes;
    }
    last = ended->radio;
    last_end = at;
  }
  CHECK(changes > 1000);
}

TEST_CASE("hidden senders collide, senders in range rarely do", "[radio][channel][NET-15]") {
  const auto hidden = two_senders(50);
  const auto in_range = two_senders(30);
  REQUIRE(hidden.sent > 3000);
  CHECK(hidden.of(copy_outcome::collision) * 20 > hidden.sent);     // above 5 %
  CHECK(in_range.of(copy_outcome::collision) * 50 < in_range.sent); // below 2 %
  CHECK(in_range.of(copy_outcome::collision) * 5 < hidden.of(copy_outcome::collision));
  CHECK(in_range.of(copy_outcome::delivered) > 3000);
}

TEST_CASE("saturated hidden senders get almost nothing through", "[radio][channel][NET-15]") {
  const auto throughput = [](double apart_m) {
    radio_fixture x;
    const auto a = x.add(1, 0);
    const auto b = x.add(2, apart_m);
    auto quick = *find_platform("iris");
    quick.service_time = 100us;
    x.add(3, apart_m / 2, 1, &quick);
    return x.saturate({a, b}, 3, 28, true, 10s);
  };
  const auto hidden = throughput(50);
  const auto in_range = throughput(30);
  CHECK(in_range > 2 * hidden);
  CHECK(in_range > 2000);
}

TEST_CASE("a crowd that hears each other keeps the channel busy and fails at times",
          "[radio][channel][NET-15]") {
  radio_fixture x;
  std::vector<radio_index> senders;
  for (std::uint16_t i = 1; i <= 30; ++i)
    senders.push_back(x.add(i, 0.1 * i));
  const auto sent = x.saturate(senders, 0xffff, 28, false, 5s);
  const auto radio_counters = x.channel.counts().by_all();
  CHECK(radio_counters.requests.failed.channel_access_failure > 100);
  CHECK(sent > 1000);
  CHECK(radio_counters.copies.of(copy_outcome::collision) > 0);
  CHECK(radio_counters.copies.of(copy_outcome::half_duplex) > 0);
  CHECK(x.channel.counts().balanced());
}

TEST_CASE("a sink under load runs out of receive slots and acks only what it took",
          "[radio][channel]") {
  auto slow = *find_platform("telosb");
  slow.service_time = 30ms;
  radio_fixture x(channel_with([](auto& c) { c.retries_max = 1; }));
  const auto sink = x.add(1, 0, 1, &slow);
  std::vector<radio_index> senders;
  for (std::uint16_t i = 2; i < 6; ++i)
    senders.push_back(x.add(i, i));
  x.saturate(senders, 1, 10, true, 10s);
  x.run_for(1s);
  const auto radio_counters = x.channel.counts().by(sink);
  CHECK(radio_counters.copies.of(copy_outcome::overflow) > 100);
  CHECK(x.channel.counts().by_all().requests.failed.no_ack > 100);
  CHECK(radio_counters.acks == radio_counters.copies.of(copy_outcome::delivered) +
                                   radio_counters.copies.of(copy_outcome::duplicate));
  // The MCU serves one frame in 30 ms and nothing more.
  CHECK(radio_counters.copies.of(copy_outcome::delivered) +
            radio_counters.copies.of(copy_outcome::duplicate) <=
        11'000 / 30 + 3);
  CHECK(radio_counters.copies.of(copy_outcome::delivered) > 300);
  CHECK(x.channel.counts().balanced());
}

TEST_CASE("the slots of a radio take exactly their number of frames", "[radio][channel]") {
  auto slow = *find_platform("micaz");
  slow.service_time = 1s;
  radio_fixture x(channel_with([](auto& c) { c.retries_max = 0; }));
  const auto a = x.add(1, 0);
  const auto sink = x.add(2, 10, 1, &slow);
  for (std::uint64_t i = 0; i < 4; ++i)
    x.send(a, i, 2, 4);
  x.run_until(instant(500ms));
  CHECK(x.delivered_to(sink) == 3);
  CHECK(x.channel.counts().by(sink).copies.of(copy_outcome::overflow) == 1);
  const auto ended = x.all<done>();
  REQUIRE(ended.size() == 4);
  for (std::size_t i = 0; i < 4; ++i)
    CHECK(ended[i].status == (i < 3 ? send_status::sent : send_status::no_ack));
  x.run_until(instant(1100ms)); // one is served
  x.send(a, 4, 2, 4);
  x.run_until(instant(1500ms));
  CHECK(x.delivered_to(sink) == 4);
}
