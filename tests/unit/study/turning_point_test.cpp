#include <vector>

#include "study/turning_point.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::study;

namespace {

/// As if of 20 futures all had it from a time on, and before that so many.
future_count answer(const turning_point::question& x, duration from, std::size_t before) {
  if (x.at >= from)
    return {x.at, 20, 20, std::nullopt};
  return x.counts_all ? future_count{x.at, before, 20, 3} : future_count{x.at, 0, 1, 1};
}

struct search {
  turning_point found;
  std::vector<turning_point::question> asked;
};

search look(duration seen, duration end, duration from, std::size_t before,
            duration within = 100ms) {
  search x{turning_point(seen, end, within), {}};
  while (const auto next = x.found.next()) {
    x.asked.push_back(*next);
    REQUIRE(x.asked.size() < 100);
    x.found.take(answer(*next, from, before));
  }
  return x;
}

} // namespace

TEST_CASE("the time from which something is certain is found by halves", "[study]") {
  const auto x = look(724s, 900s, 123'456ms, 3);
  CHECK(x.found.certain_from() >= 123'456ms);
  CHECK(x.found.certain_from() < 123'556ms);
  REQUIRE(x.found.before());
  CHECK(x.found.before()->at < 123'456ms);
  CHECK(x.found.certain_from() - x.found.before()->at <= 100ms);
  CHECK(x.found.before()->with == 3);
  CHECK(x.found.before()->of == 20);
  CHECK(x.found.at_start() == future_count{0s, 3, 20, 3});
  CHECK(!x.found.only_at_end());
  CHECK(x.asked.size() <= 17);
  CHECK(x.asked[0] == turning_point::question{0s, true});
  CHECK(x.asked[1] == turning_point::question{724s, false});
  CHECK(x.asked.back() == turning_point::question{x.found.before()->at, true});
}

TEST_CASE("a millisecond is the finest time", "[study]") {
  const auto x = look(900'500us, 2s, 500'700us, 0, 1ms);
  CHECK(x.found.certain_from() == 501ms);
  CHECK(x.found.before()->at == 500ms);
}

TEST_CASE("what is certain from the start takes one question", "[study]") {
  const auto x = look(20s, 60s, 0s, 20);
  CHECK(x.asked.size() == 1);
  CHECK(x.found.certain_from() == 0s);
  CHECK(!x.found.before());
}

TEST_CASE("what is seen before it is certain is looked for after that", "[study]") {
  const auto x = look(20s, 60s, 40s, 5);
  CHECK(x.found.certain_from() >= 40s);
  CHECK(x.found.certain_from() <= 40'100ms);
  const auto last = look(60s, 60s, 60s, 5); // which nothing but the end of the run decides
  CHECK(last.found.only_at_end());
  CHECK(last.found.before()->with == 5);
}

TEST_CASE("a turn soon after the start is not counted twice", "[study]") {
  const auto x = look(60ms, 1s, 50ms, 4);
  CHECK(x.found.before() == x.found.at_start());
  CHECK(x.asked.size() == 2);
}
