// What a neighbour may have us do.
#include "peis/link/neighbour_budget.hpp"

#include "support/catch.hpp"

namespace rubicon::peis {
namespace {

constexpr budget_config small{1'000'000, 1'000, 10'000, 500ms, 2s};

} // namespace

TEST_CASE("a budget has a rate and a burst", "[peis][P2P-03]") {
  neighbour_budget x(small);
  const instant start{10s};
  CHECK(x.is_within(start));
  for (int i = 0; i < 500; ++i)
    x.charge_package(100, start);
  CHECK(x.is_within(start)); // 500 ms of the 1 000 a second
  x.charge_package(100, start);
  CHECK_FALSE(x.is_within(start));
  CHECK(x.free_at() == start + 1ms);
  CHECK(x.is_within(start + 1ms));
  for (int i = 0; i < 2000; ++i) { // at the rate, for ever
    const auto now = start + std::chrono::milliseconds(i + 1);
    CHECK(x.is_within(now));
    x.charge_package(100, now);
  }
}

TEST_CASE("each of octets, packages and work can exhaust a budget", "[peis][P2P-03]") {
  const instant start{};
  neighbour_budget octets(small);
  octets.charge_package(600'000, start);
  CHECK(octets.free_at() == start + 100ms);
  neighbour_budget work(small);
  work.charge_work(6'000, start);
  CHECK(work.free_at() == start + 100ms);
  CHECK(work.work_done() == 6'000);
}

TEST_CASE("what is charged after it was done makes wait for a limited time", "[peis][P2P-03]") {
  neighbour_budget x(small);
  const instant start{5s};
  x.charge_work(1'000'000'000'000, start);
  x.charge_work(1'000'000'000'000, start);
  CHECK(x.free_at() == start + 2s);
}

} // namespace rubicon::peis
