#include "report/fault_plan.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::report;

namespace {

config::fault_description once(duration at) {
  return {at, config::pause_fault{peer_id{1}, 10s}};
}

config::fault_description often(config::fault_times times) {
  return {times.from, config::pause_fault{peer_id{1}, 10s}, times};
}

std::vector<planned_fault> plan(std::vector<config::fault_description> faults,
                                duration length = 10min, std::uint64_t seed = 1) {
  config::ecology_description x;
  x.length = length;
  x.seed = seed;
  x.faults = std::move(faults);
  return plan_faults(x);
}

} // namespace

TEST_CASE("faults happen in the order of their times", "[report][ACT-04]") {
  CHECK(plan({}).empty());
  CHECK(plan({once(2s), once(1s), once(2s)}) ==
        std::vector<planned_fault>{{1s, 1}, {2s, 0}, {2s, 2}});
}

TEST_CASE("a periodic fault happens from its first to its last moment", "[report][ACT-04]") {
  CHECK(plan({often({10s, 0, 5s, 25s})}) ==
        std::vector<planned_fault>{{5s, 0}, {15s, 0}, {25s, 0}});
  CHECK(plan({often({4min, 0, 0s, std::nullopt})}).size() == 3);
  CHECK(plan({often({10s, 0, 5s, 25s})}, 14s) == std::vector<planned_fault>{{5s, 0}});
  CHECK(plan({often({10s, 0, 5s, 25s})}, 4s).empty());
  CHECK(plan({once(10min), once(10min + 1ns)}).size() == 1);
}

TEST_CASE("random moments of a run that was made shorter are all within it", "[report][ACT-04]") {
  const auto all = plan({often({0s, 20, 1min, 10min})}, 2min);
  CHECK(all.size() == 20);
  CHECK(all.back().at <= 2min);
}

TEST_CASE("random moments depend on the seed and on nothing else", "[report][ACT-04][GEN-07]") {
  const auto fault = often({0s, 20, 1min, 2min});
  const auto first = plan({fault});
  REQUIRE(first.size() == 20);
  for (std::size_t i = 0; i < first.size(); ++i) {
    CHECK(first[i].at >= 1min);
    CHECK(first[i].at <= 2min);
    CHECK((i == 0 || first[i - 1].at <= first[i].at));
  }
  CHECK(plan({fault}) == first);
  CHECK(plan({fault}, 10min, 2) != first);
  const auto both = plan({fault, fault});
  REQUIRE(both.size() == 40);
  std::vector<planned_fault> of_first;
  for (const auto& each : both) {
    if (each.index == 0)
      of_first.push_back(each);
  }
  CHECK(of_first == first);
}
