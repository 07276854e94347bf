#include <cmath>

#include "network/clock/network_offset.hpp"
#include "network/clock/round_schedule.hpp"
#include "network/clock/tick_settings.hpp"
#include "network/clock/time_estimate.hpp"
#include "support/catch.hpp"

namespace rubicon::network {

namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr tick_setting every_500_ms{0, island_time(10s), milliseconds{500}};
constexpr tick_setting every_second{20, island_time(20s), milliseconds{1000}};

/// Of an estimate that has one point, at which both clocks show the same time.
time_estimate estimate_at(instant own) {
  time_estimate x;
  static_cast<void>(x.take({own, 0, microseconds{20}}, {.is_news = true}));
  return x;
}

} // namespace

TEST_CASE("a tick setting holds from its beginning on", "[network][CLK-03]") {
  tick_settings x;
  CHECK_FALSE(x.known());
  CHECK_FALSE(x.at(island_time(1s)));
  x.learn(every_500_ms);
  CHECK(x.at(std::nullopt) == every_500_ms); // the first one known
  CHECK(x.at(island_time(1s)) == every_500_ms);
  x.learn(every_second);
  CHECK(x.newest() == every_second);
  CHECK(x.at(island_time(20s) - microseconds{1}) == every_500_ms);
  CHECK(x.at(island_time(20s)) == every_second);
  CHECK(x.at(std::nullopt) == every_500_ms);
  x.learn(every_500_ms); // the other one was taken back
  CHECK(x.newest() == every_500_ms);
  CHECK(x.at(island_time(30s)) == every_500_ms);
  x.replace(every_second);
  CHECK(x.at(island_time(1s)) == every_second);
}

TEST_CASE("ticks go on where the time is another", "[network][CLK-03]") {
  tick_settings x;
  x.learn({7, island_time(10s), milliseconds{500}});
  x.move(microseconds{-9'300'000});
  CHECK(x.newest() == tick_setting{6, island_time(200ms), milliseconds{500}}); // 7 at 700 ms
}

TEST_CASE("a network time goes on at its own rate", "[network][CLK-08]") {
  CHECK_FALSE(network_offset().at(island_time(1s)));
  const network_offset x({{microseconds{1000}, 20e-6}}, island_time(5s));
  CHECK(x.at(island_time(5s))->ahead == microseconds{1000});
  CHECK(x.at(island_time(15s))->ahead == microseconds{1200});
  CHECK(x.at(island_time(0s))->ahead == microseconds{900});
}

TEST_CASE("a root listens before its first round, shorter once it was answered",
          "[network][CLK-04]") {
  round_schedule x(round_config(), instant{1s});
  CHECK(x.is_listening());
  CHECK(x.deadline() == instant{4s});
  x.restart(instant{1s}); // its first round comes when it has listened
  CHECK(x.deadline() == instant{4s});
  x.on_answer(instant{2s});
  CHECK(x.deadline() == instant{2s} + round_config::resume_more);
  x.on_answer(instant{3s});
  CHECK(x.deadline() == instant{2s} + round_config::resume_more);
  CHECK_FALSE(round_schedule(round_config()).deadline()); // of a mote
}

TEST_CASE("rounds are near each other after a change, and as rare as requested later",
          "[network][CLK-01]") {
  round_schedule x(round_config(), instant{});
  x.stop_listening();
  x.restart(instant{});
  auto now = instant{};
  for (const auto gap : {1s, 1s, 1s, 1s, 2s, 4s, 8s, 16s, 32s, 60s, 60s}) {
    CHECK(x.is_due(now));
    x.advance(now);
    CHECK(x.deadline() == now + gap);
    CHECK_FALSE(x.is_due(now));
    now += gap;
  }
  x.advance(now);
  x.request(20s, now);
  CHECK(x.deadline() == now + 20s);
  x.request(40s, now); // another needs more
  CHECK(x.deadline() == now + 20s);
  x.request(1s, now);
  CHECK(x.deadline() == now + round_config().period_least);
  x.advance(now);
  CHECK(x.deadline() == now + round_config().period_least);
  now += round_config::request_hold;
  x.advance(now);
  CHECK(x.deadline() == now + 20s); // twice the gap before: the request has ended
}

TEST_CASE("a dispute does not restart the rounds again and again", "[network][CLK-04]") {
  round_schedule x(round_config(), instant{});
  x.stop_listening();
  x.restart_for_dispute(instant{10s});
  CHECK(x.deadline() == instant{10s});
  x.advance(instant{10s});
  x.restart_for_dispute(instant{20s} - 1ns);
  CHECK(x.deadline() == instant{11s});
  x.restart_for_dispute(instant{20s});
  CHECK(x.deadline() == instant{20s});
}

TEST_CASE("a point far off the line is disputed until another agrees", "[network][CLK-05]") {
  for (const bool agrees : {true, false}) {
    auto x = estimate_at(instant{1s});
    CHECK(x.doubt(instant{1s}) < microseconds{100});
    CHECK(x.take({instant{2s}, 50'000, microseconds{20}}, {}) == point_fate::disputed);
    CHECK(x.is_disputed());
    CHECK(x.doubt(instant{2s}) >= microseconds{50'000});
    CHECK(x.line().doubt(instant{2s}) < microseconds{1000});
    const auto next = agrees ? 50'000 : 0;
    CHECK(x.take({instant{3s}, next, microseconds{20}}, {.is_news = true}) ==
          (agrees ? point_fate::restarted : point_fate::taken));
    CHECK_FALSE(x.is_disputed());
    CHECK(x.at(instant{3s}) == island_time(3s + microseconds{next}));
    CHECK(x.steps() == (agrees ? 1 : 0));
    CHECK(x.last_leap() == microseconds{next});
  }
}

TEST_CASE("a time that is distrusted takes a point that is believed", "[network][CLK-05]") {
  auto x = estimate_at(instant{1s});
  x.distrust();
  CHECK(x.is_disputed());
  CHECK(x.take({instant{2s}, 50'000, microseconds{20}}, {.is_believed = true}) ==
        point_fate::restarted);
  CHECK_FALSE(x.is_distrusted());
}

TEST_CASE("a root's own time is exact, and ends a dispute", "[network][CLK-04]") {
  auto x = estimate_at(instant{1s});
  static_cast<void>(x.take({instant{2s}, 50'000, microseconds{20}}, {}));
  x.set(island_time(100s), instant{5s});
  CHECK(x.is_own());
  CHECK(x.synchronised());
  CHECK_FALSE(x.is_disputed());
  CHECK(x.at(instant{6s}) == island_time(101s));
  CHECK(x.doubt(instant{1000s}) == microseconds{0});
}

TEST_CASE("an estimate that is forgotten has no time, which counts once", "[network][CLK-05]") {
  auto x = estimate_at(instant{1s});
  x.forget();
  x.forget();
  CHECK_FALSE(x.synchronised());
  CHECK(x.steps() == 1);
}

} // namespace rubicon::network
