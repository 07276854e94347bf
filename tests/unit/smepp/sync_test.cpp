#include <cmath>

#include "smepp/groups/member_table.hpp"
#include "smepp/weak_sync.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::smepp;

namespace {

/// A member whose crystal is wrong by some ppm.
struct node {
  node(std::uint16_t id, double ppm, instant now) : rate(1 + ppm * 1e-6) {
    sync = weak_sync({.self = mote_id{id}}, random_stream(id), own(now));
    self = mote_id{id};
  }

  [[nodiscard]] instant own(instant x) const {
    return instant(
        duration(std::llround(static_cast<double>(x.time_since_epoch().count()) * rate)));
  }

  mote_id self;
  double rate;
  weak_sync sync;
};

/// One stamp from one to others, as the radio has it.
void say(node& from, std::initializer_list<node*> to, instant at) {
  sync_stamp x;
  from.sync.stamp(x, from.own(at - 3ms)); // the radio waits for a free channel
  for (auto* const each : to)
    each->sync.on_stamp(from.self, x, each->own(at));
  from.sync.on_stamp_sent(from.own(at));
}

double error_us(const node& a, const node& b, instant at) {
  return static_cast<double>((a.sync.at(a.own(at)) - b.sync.at(b.own(at))).count());
}

constexpr instant start{100s};

} // namespace

TEST_CASE("two stamps in a row give the time to some microseconds", "[smepp][SMP-26]") {
  node root(1, 80, start);
  node other(2, -90, start);
  CHECK_FALSE(other.sync.is_known());
  root.sync.begin(root.own(start));
  say(root, {&other}, start + 1s);
  CHECK(other.sync.is_known());
  CHECK_FALSE(other.sync.is_fine());
  CHECK(std::abs(error_us(root, other, start + 1s)) < 5000); // for the time it took to the air
  for (int i = 0; i < 6; ++i)
    say(root, {&other}, start + 2s + i * 30s);
  CHECK(other.sync.is_fine());
  CHECK(other.sync.root() == mote_id{1});
  CHECK(std::abs(other.sync.rate() - 170e-6) < 1e-6);
  for (int minutes = 3; minutes < 20; ++minutes)
    CHECK(std::abs(error_us(root, other, start + minutes * 1min)) < 100);
  const auto now = other.own(start + 10min);
  CHECK(std::chrono::abs(other.sync.when(other.sync.at(now)) - now) <= 2us);
}

TEST_CASE("a stamp that does not follow one that was received shows nothing", "[smepp][SMP-26]") {
  node root(1, 0, start);
  node other(2, 50, start);
  root.sync.begin(root.own(start));
  say(root, {&other}, start + 1s);
  say(root, {}, start + 2s); // lost
  say(root, {&other}, start + 3s);
  CHECK_FALSE(other.sync.is_fine());
  say(root, {&other}, start + 4s);
  say(root, {&other}, start + 5s);
  CHECK(other.sync.is_fine());
}

TEST_CASE("a root that is gone is replaced, and its last words do not bring it back",
          "[smepp][SMP-22][SMP-26]") {
  node root(1, 60, start);
  node a(2, -60, start);
  node b(3, 20, start);
  root.sync.begin(root.own(start));
  auto at = start;
  for (int i = 0; i < 5; ++i)
    say(root, {&a, &b}, at += 2s);
  for (const auto end = at + 30min; at < end; at += 10s)
    for (auto* const each : {&a, &b})
      if (each->sync.on_time(each->own(at)))
        say(*each, {each == &a ? &b : &a}, at);
  CHECK(a.sync.root() != mote_id{1});
  CHECK(a.sync.root() == b.sync.root());
  CHECK(std::abs(error_us(a, b, at)) < 100);

  // It comes back with another time, and is better: then it is news, and a jump.
  node again(1, 60, at);
  again.sync.begin(again.own(at));
  auto& leader = a.sync.is_root() ? a : b;
  auto news = weak_sync::news::none;
  for (int i = 0; i < 40; ++i) {
    sync_stamp x;
    at += 1s;
    again.sync.stamp(x, again.own(at));
    const auto result = leader.sync.on_stamp(again.self, x, leader.own(at));
    again.sync.on_stamp_sent(again.own(at));
    if (result == weak_sync::news::jumped)
      news = result;
  }
  CHECK(news == weak_sync::news::jumped);
  CHECK(leader.sync.root() == mote_id{1});
  CHECK(std::abs(error_us(again, leader, at)) < 100);
}

TEST_CASE("stamps of any content leave a clock that goes on", "[smepp][SMP-26]") {
  random_stream rng(9);
  node x(5, 0, start);
  auto at = start;
  for (int i = 0; i < 20'000; ++i) {
    at += rng.between(1ms, 1s);
    sync_stamp said;
    said.sequence = static_cast<std::uint16_t>(rng.below(4));
    const auto some_time = [&] {
      return group_time(std::chrono::microseconds(static_cast<std::int64_t>(rng.next() >> 16)));
    };
    if (rng.chance(0.7))
      said.of_last = some_time();
    said.now = some_time();
    said.root = mote_id{static_cast<std::uint16_t>(1 + rng.below(8))};
    said.round = static_cast<std::uint16_t>(rng.next());
    said.hops = static_cast<std::uint8_t>(rng.next());
    x.sync.on_stamp(mote_id{static_cast<std::uint16_t>(1 + rng.below(20))}, said, x.own(at));
    REQUIRE(x.sync.is_known());
    REQUIRE(std::abs(x.sync.rate()) <= weak_sync::rate_max);
    const auto now = x.own(at);
    REQUIRE(x.sync.at(now + 1s) - x.sync.at(now) > 999ms);
    static_cast<void>(x.sync.on_time(now));
  }
}

TEST_CASE("tables of members become equal in whatever order news comes",
          "[smepp][SMP-10][SMP-12]") {
  random_stream rng(3);
  for (int round = 0; round < 200; ++round) {
    std::vector<member> news;
    for (int i = 0; i < 30; ++i)
      news.push_back({{mote_id{static_cast<std::uint16_t>(1 + rng.below(8))},
                       static_cast<transducer_mask>(rng.below(3))},
                      static_cast<std::uint16_t>(rng.below(5)),
                      rng.chance(0.4)});
    member_table a;
    member_table b;
    for (const auto& x : news)
      a.learn(x);
    for (std::size_t i = news.size(); i-- > 1;)
      std::swap(news[i], news[rng.below(i + 1)]);
    for (const auto& x : news)
      b.learn(x);
    CHECK(a.digest() == b.digest());
    CHECK(a.descriptions() == b.descriptions());
  }
  member_table small(2);
  using enum member_table::change;
  CHECK(small.learn({{mote_id{1}, 0}, 1, false}) == joined);
  CHECK(small.learn({{mote_id{2}, 0}, 1, false}) == joined);
  CHECK(small.learn({{mote_id{3}, 0}, 1, false}) == no_room);
  CHECK(small.learn({{mote_id{2}, 0}, 2, true}) == left);
  CHECK(small.learn({{mote_id{2}, 0}, 1, false}) == none); // old news
  CHECK(small.learn({{mote_id{3}, 0}, 1, false}) == joined);
  CHECK(small.present() == 2);
}
