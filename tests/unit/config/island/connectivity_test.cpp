#include <algorithm>

#include "config/checks/connectivity.hpp"
#include "core/numbers/math.hpp"
#include "core/numbers/random.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using config::disconnected_from;
using indices = std::vector<std::size_t>;

TEST_CASE("chains of places lead as far as each step is within range", "[config][GEN-06]") {
  CHECK(disconnected_from({0, 0, 0}, {}, 10).empty());
  CHECK(disconnected_from({0, 0, 0}, {{10, 0, 0}, {0, 10, 0}, {0, 0, -10}}, 10).empty());
  CHECK(disconnected_from({0, 0, 0}, {{20, 0, 0}, {10, 0, 0}}, 10).empty());
  CHECK(disconnected_from({0, 0, 0}, {{20.1, 0, 0}, {10, 0, 0}}, 10) == indices{0});
  CHECK(disconnected_from({0, 0, 0}, {{8, 8, 0}, {0, 9, 9}}, 10) == indices{0, 1});
  CHECK(disconnected_from({0, 0, 0}, {{50, 0, 0}, {0, 0, 0}, {55, 0, 0}}, 10) == indices{0, 2});
}

TEST_CASE("which places are out of reach does not depend on the grid they are looked up in",
          "[config][GEN-06]") {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    random_stream rng(seed);
    const auto draw = [&rng] {
      return position{rng.unit() * 100 - 50, rng.unit() * 100 - 50, rng.unit() * 20 - 10};
    };
    const position from = draw();
    std::vector<position> places(60);
    std::ranges::generate(places, draw);
    const double range = 8 + rng.unit() * 8;
    const auto near = [range](const position& a, const position& b) {
      return math::length(a.x_m - b.x_m, a.y_m - b.y_m, a.z_m - b.z_m) <= range;
    };
    std::vector<bool> reached(places.size());
    for (std::size_t round = 0; round < places.size(); ++round) {
      for (std::size_t i = 0; i < places.size(); ++i) {
        bool next = near(from, places[i]);
        for (std::size_t j = 0; j < places.size(); ++j)
          next = next || (reached[j] && near(places[i], places[j]));
        reached[i] = next;
      }
    }
    indices expected;
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (!reached[i])
        expected.push_back(i);
    }
    CHECK(disconnected_from(from, places, range) == expected);
  }
}
