#include "network/beacon.hpp"
#include "network/tree/trickle.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::network;

namespace {

beacon sample() {
  beacon x;
  x.sequence = 0x0102;
  x.next_quarters = 0x03;
  x.gradient = {mote_id{0x0405}, 0x0607, mote_id{0x0809}, 0x0a0b, 0x0c};
  x.coordinates.epoch = 0x0d0e;
  x.coordinates.anchors[anchor_w] = {mote_id{0x0f10}, 0x1112, 0x13};
  x.coordinates.anchors[anchor_x] = {mote_id{0x1415}, 0x1617, 0x18};
  x.coordinates.anchors[anchor_y] = {mote_id{0x191a}, 0x1b1c, 0x1d, true};
  x.coordinates.candidate = {mote_id{0x1e1f}, 0x20, 0x21};
  x.clock.root = mote_id{0x2223};
  x.clock.era = 0xe7;
  x.clock.sequence = 0x2425;
  x.clock.time = island_time(std::chrono::microseconds(0x262728292a2b));
  x.clock.age_us = 0x2c2d2e2f;
  x.clock.tick = {0x30313233, island_time(std::chrono::microseconds(0x343536373839)),
                  std::chrono::milliseconds(0x1a3b)};
  x.clock.slots_used = 1; // with the period: 0x3a3b
  x.heard = {{mote_id{0x3c3d}, 0x3e}, {mote_id{0x3f40}, 0x41}};
  return x;
}

} // namespace

TEST_CASE("a beacon has the octets that its header describes", "[network][NET-14]") {
  const std::string text = "0102"
                           "0003"
                           "04050607"
                           "08090a0b"
                           "0c"
                           "0d0e"
                           "0f10111213"
                           "1415161718"
                           "191a1b1c9d"
                           "fffd0000ff"
                           "1e1f2021"
                           "2223e72425"
                           "262728292a2b"
                           "2c2d2e2f"
                           "30313233"
                           "343536373839"
                           "3a3b"
                           "00"
                           "3c3d3e"
                           "3f4041";
  CHECK(to_hex(encode(sample())) == text);
  const auto read = decode_beacon(*from_hex(text));
  REQUIRE(read);
  CHECK(*read == sample());
}

TEST_CASE("a beacon with a full list fits a frame, and each wrong length is refused",
          "[network][NET-14]") {
  auto x = sample();
  x.heard.assign(beacon::heard_max(x.clock), {mote_id{1}, 255});
  const auto octets = encode(x);
  CHECK(octets.size() <= frame_payload_max);
  CHECK(beacon::heard_max(x.clock) == 15);
  x.clock.network = network_line{std::chrono::microseconds(1), 0};
  x.heard.resize(beacon::heard_max(x.clock));
  CHECK(encode(x).size() <= frame_payload_max);
  CHECK(beacon::heard_max(x.clock) == 12);
  for (std::size_t size = 0; size < octets.size(); ++size) {
    const auto cut = decode_beacon(byte_view(octets).first(size));
    const bool is_whole = size >= beacon::header_size && (size - beacon::header_size) % 3 == 0;
    CHECK(static_cast<bool>(cut) == is_whole);
    if (!cut)
      CHECK(cut.error() == errc::truncated);
  }
  CHECK(decode_beacon(bytes(frame_payload_max + 1)).error() == errc::too_long);
}

TEST_CASE("a list with the id of no mote is refused", "[network][NET-14]") {
  for (const auto id : {mote_id{}, no_mote, own_mote, broadcast_mote}) {
    auto x = sample();
    x.heard[1].mote = id;
    CHECK(decode_beacon(encode(x)).error() == errc::bad_value);
  }
}

TEST_CASE("a beacon says how well it receives us, and whether the link matters for a route",
          "[network][NET-10]") {
  auto x = sample();
  const auto listed = x.report(mote_id{7}, mote_id{0x3f40}, true);
  CHECK(listed.source == mote_id{7});
  CHECK(listed.sequence == 0x0102);
  CHECK(listed.next == 750ms);
  CHECK(listed.hears_us == 0x41);
  CHECK(!listed.matters);
  CHECK(!x.report(mote_id{7}, mote_id{3}, true).hears_us);
  CHECK(x.report(mote_id{7}, mote_id{3}, false).matters);
  x.gradient.cost = etx_infinite;
  CHECK(x.report(mote_id{7}, mote_id{3}, true).matters);
  CHECK(!x.report(mote_id{7}, mote_id{3}, false).matters);
}

TEST_CASE("the time until the next beacon is rounded up to quarters", "[network]") {
  CHECK(quarters(0ns) == 0);
  CHECK(quarters(1ns) == 1);
  CHECK(quarters(250ms) == 1);
  CHECK(quarters(24s) == 96);
  CHECK(quarters(1h) == 14400);
  CHECK(quarters(24h) == 65535);
  CHECK(quarters(-1s) == 0);
}

TEST_CASE("trickle fires once in the second half of intervals that double up to the longest",
          "[network][NET-11]") {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    trickle timer({.interval_max = 16s}, random_stream(seed), instant{} + 1s);
    auto begin = instant{} + 1s;
    for (auto interval = duration(125ms); begin < instant{} + 2min;) {
      const auto due = timer.deadline();
      CHECK(due >= begin + interval / 2);
      CHECK(due < begin + interval);
      CHECK(!timer.on_time(due - 1ns));
      CHECK(timer.on_time(due));
      CHECK(timer.deadline() > due);
      begin += interval;
      interval = std::min<duration>(2 * interval, 16s);
    }
  }
}

TEST_CASE("a reset begins a shortest interval unless one is in flight", "[network][NET-11]") {
  trickle timer({}, random_stream(3), instant{});
  const auto first = timer.deadline();
  timer.reset(instant{} + 100ms);
  CHECK(timer.deadline() == first);
  for (int i = 0; i < 8; ++i)
    static_cast<void>(timer.on_time(timer.deadline()));
  const auto now = timer.deadline() - 8s;
  timer.reset(now);
  CHECK(timer.deadline() >= now + 62500us);
  CHECK(timer.deadline() < now + 125ms);
}

TEST_CASE("a trickle is shortened to an interval unless one so short is in flight",
          "[network][NET-11]") {
  trickle timer({}, random_stream(3), instant{});
  const auto first = timer.deadline();
  timer.shorten(instant{} + 10ms, 1s);
  CHECK(timer.deadline() == first); // 125 ms is shorter
  for (int i = 0; i < 8; ++i)
    static_cast<void>(timer.on_time(timer.deadline()));
  const auto now = timer.deadline() - 8s;
  timer.shorten(now, 1s);
  const auto soon = timer.deadline();
  CHECK(soon >= now + 500ms);
  CHECK(soon < now + 1s);
  timer.shorten(now + 100ms, 1s); // is in flight
  CHECK(timer.deadline() == soon);
  CHECK(timer.on_time(soon));
  CHECK(timer.deadline() >= now + 2s); // and it doubles from there
  CHECK(timer.deadline() < now + 3s);
}

TEST_CASE("a trickle that is served late fires once, not for all it has missed", "[network]") {
  trickle timer({}, random_stream(3), instant{});
  CHECK(timer.on_time(instant{} + 1h));
  CHECK(timer.deadline() > instant{} + 1h);
}

TEST_CASE("in short intervals a trickle keeps quiet if enough others fire, in the longest never",
          "[network][NET-11]") {
  trickle timer({}, random_stream(3), instant{});
  const auto fires_after = [&timer](int others) {
    for (int i = 0; i < others; ++i)
      timer.hear();
    return timer.on_time(timer.deadline());
  };
  CHECK_FALSE(fires_after(6));
  CHECK(fires_after(0)); // what others did counts in its interval only
  CHECK(fires_after(5));
  CHECK_FALSE(fires_after(7));
  while (timer.certain() != timer.deadline())
    static_cast<void>(fires_after(0));
  CHECK(fires_after(100));
}

TEST_CASE("a trickle fires in its first longest interval at the latest", "[network][NET-11]") {
  trickle timer({.interval_max = 16s}, random_stream(3), instant{} + 1s);
  CHECK(timer.certain() == instant{} + 1s + 31875ms); // 125 ms, doubled up to 16 s
  while (!timer.on_time(timer.deadline())) {
  }
  CHECK(timer.certain() == instant{} + 1s + 31875ms);
}

TEST_CASE("shortest intervals follow each other as often as is wished", "[network][NET-11]") {
  trickle timer({.interval_min = 4s, .interval_max = 64s, .shortest = 3}, random_stream(3),
                instant{});
  const auto fires_in = [&](duration from, duration to) {
    const auto due = timer.deadline();
    CHECK(due >= instant{} + from);
    CHECK(due < instant{} + to);
    CHECK(timer.on_time(due));
  };
  CHECK(timer.certain() == instant{} + 4s + 4s + 4s + 8s + 16s + 32s + 64s);
  fires_in(2s, 4s);
  fires_in(6s, 8s);
  fires_in(10s, 12s);
  fires_in(16s, 20s);
  timer.reset(instant{} + 20s);
  fires_in(22s, 24s);
  fires_in(26s, 28s);
}

TEST_CASE("what was done for another reason counts once nothing changes", "[network][NET-11]") {
  trickle timer({.interval_min = 1s, .interval_max = 4s}, random_stream(3), instant{});
  timer.done(instant{} + 400ms);
  CHECK(timer.deadline() < instant{} + 1s);
  while (timer.certain() != timer.deadline())
    CHECK(timer.on_time(timer.deadline()));
  const auto now = timer.deadline() - 1ms;
  timer.done(now);
  CHECK(timer.deadline() >= now + 2s);
}

TEST_CASE("a beacon that lists as many as a table holds comes from a crowd", "[network][NET-10]") {
  auto x = sample();
  x.heard.assign(beacon::crowd - 1, {mote_id{9}, 200});
  CHECK_FALSE(x.report(mote_id{3}, mote_id{4}, true).is_crowded);
  x.heard.push_back({mote_id{9}, 200});
  CHECK(x.report(mote_id{3}, mote_id{4}, true).is_crowded);
}
