#include "core/small_map.hpp"

#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/numbers/random.hpp"
#include "support/catch.hpp"

using namespace rubicon;

TEST_CASE("a small map behaves like a tree under any mixture of operations", "[core]") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    random_stream rng(seed);
    small_map<int, std::string> tested;
    std::map<int, std::string> expected;
    for (int i = 0; i < 2000; ++i) {
      const auto x = static_cast<int>(rng.below(12));
      const auto value = std::to_string(i);
      switch (rng.below(6)) {
      case 0:
        tested[x] = value;
        expected[x] = value;
        break;
      case 1:
        REQUIRE(tested.emplace(x, value) == expected.emplace(x, value).second);
        break;
      case 2: {
        const auto taken = tested.extract(x);
        const auto node = expected.extract(x);
        REQUIRE(taken.has_value() == !node.empty());
        REQUIRE((!taken || *taken == node.mapped()));
        break;
      }
      case 3:
        tested.erase(x);
        expected.erase(x);
        break;
      case 4: {
        const auto at = tested.find(x);
        REQUIRE((at != tested.end()) == expected.contains(x));
        if (at != tested.end()) {
          REQUIRE(tested.at(x) == expected.at(x));
          const auto next = tested.erase(at);
          const auto after = expected.erase(expected.find(x));
          REQUIRE((next == tested.end()) == (after == expected.end()));
        } else {
          REQUIRE_THROWS_AS(tested.at(x), std::out_of_range);
        }
        break;
      }
      default: {
        const auto is_even = [](const auto& each) { return each.second.size() % 2 == 0; };
        if (rng.below(20) == 0) {
          tested.erase_if(is_even);
          std::erase_if(expected, is_even);
        }
      }
      }
      REQUIRE(tested.size() == expected.size());
      REQUIRE(tested.empty() == expected.empty());
      REQUIRE(tested.contains(x) == expected.contains(x));
    }
    const std::vector<std::pair<int, std::string>> all(expected.begin(), expected.end());
    REQUIRE(std::vector<std::pair<int, std::string>>(tested.begin(), tested.end()) == all);
  }
}
