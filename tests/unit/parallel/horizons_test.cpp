#include "parallel/horizons.hpp"

#include <map>

#include "core/numbers/random.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using parallel::horizons;
using parallel::never;

namespace {

instant at_ms(std::int64_t ms) {
  return instant(ms * 1ms);
}

std::vector<instant> safe_for(horizons& x, const std::vector<instant>& next) {
  const auto safe = x.of(next);
  return {safe.begin(), safe.end()};
}

/// When what each process does next can first have come to `to`, over any chain of links.
instant first_arrival(const std::vector<std::vector<std::optional<duration>>>& links,
                      const std::vector<instant>& next, std::size_t to) {
  auto shortest = std::vector(next.size(), std::vector(next.size(), duration::max()));
  for (std::size_t i = 0; i < next.size(); ++i)
    for (std::size_t j = 0; j < next.size(); ++j)
      if (links[i][j])
        shortest[i][j] = *links[i][j];
  for (std::size_t k = 0; k < next.size(); ++k)
    for (std::size_t i = 0; i < next.size(); ++i)
      for (std::size_t j = 0; j < next.size(); ++j)
        if (shortest[i][k] != duration::max() && shortest[k][j] != duration::max())
          shortest[i][j] = std::min(shortest[i][j], shortest[i][k] + shortest[k][j]);
  auto first = never;
  for (std::size_t i = 0; i < next.size(); ++i)
    if (shortest[i][to] != duration::max())
      first = std::min(first, parallel::later(next[i], shortest[i][to]));
  return first;
}

} // namespace

TEST_CASE("who hears of nobody may run to the end of time", "[parallel][NFR-08]") {
  horizons x;
  CHECK(safe_for(x, {at_ms(3), at_ms(1)}) == std::vector{never, never});
  x.link(0, 1, 2ms);
  CHECK(safe_for(x, {at_ms(3), at_ms(1)}) == std::vector{never, at_ms(5)});
  CHECK(safe_for(x, {never, at_ms(1)}) == std::vector{never, never});
}

TEST_CASE("what a process causes elsewhere may come back to it", "[parallel][NFR-08]") {
  horizons x;
  x.link(0, 1, 2ms);
  x.link(1, 0, 3ms);
  CHECK(safe_for(x, {at_ms(1), never}) == std::vector{at_ms(6), at_ms(3)});
  CHECK(safe_for(x, {at_ms(1), at_ms(100)}) == std::vector{at_ms(6), at_ms(3)});
  CHECK(safe_for(x, {at_ms(1), at_ms(2)}) == std::vector{at_ms(5), at_ms(3)});
}

TEST_CASE("nothing comes before the horizon, over any chain of links, and something may come at it",
          "[parallel][NFR-08]") {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    random_stream rng(seed);
    const auto count = 2 + rng.below(7);
    std::vector links(count, std::vector<std::optional<duration>>(count));
    horizons x;
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t j = 0; j < count; ++j)
        if (i != j && rng.chance(0.4)) {
          links[i][j] = duration(1 + rng.below(1000));
          x.link(i, j, *links[i][j]);
        }
    for (int round = 0; round < 5; ++round) {
      std::vector<instant> next;
      for (std::size_t i = 0; i < count; ++i)
        next.push_back(rng.chance(0.2) ? never : instant(duration(rng.below(2000))));
      const auto safe = safe_for(x, next);
      for (std::size_t i = 0; i < count; ++i)
        REQUIRE(safe[i] == first_arrival(links, next, i));
    }
  }
}

TEST_CASE("of several links the shortest counts, and without a link there is no delay short enough",
          "[parallel][NFR-08]") {
  horizons x;
  x.link(0, 1, 5ms);
  x.link(0, 1, 2ms);
  CHECK(x.delay(0, 1) == 2ms);
  CHECK(x.delay(1, 0) == duration::max());
  CHECK(safe_for(x, {at_ms(0), never}) == std::vector{never, at_ms(2)});
}

TEST_CASE("each of many links has its own delay, in whatever order they are declared",
          "[parallel][NFR-06][NFR-08]") {
  constexpr std::size_t places = 1000;
  horizons x;
  for (std::size_t i = 0; i < places; ++i) {
    const auto place = 1 + i * 387 % places; // all of them once, as 387 is prime to their number
    x.link(place, 0, duration(place));
    x.link(0, place, duration(places + place));
  }
  for (std::size_t place = 1; place <= places; ++place) {
    REQUIRE(x.delay(place, 0) == duration(place));
    REQUIRE(x.delay(0, place) == duration(places + place));
    REQUIRE(x.delay(place, place % places + 1) == duration::max());
  }
}
