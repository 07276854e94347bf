#include <cmath>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/numbers/random.hpp"
#include "study/stopping.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::study;

namespace {

using values = std::vector<std::optional<double>>;

stop_rule rule(const std::string& text) {
  return std::get<stop_rule>(parse_stop_rule(text));
}

} // namespace

TEST_CASE("a rule has a figure and a limit, of the mean or as a number", "[study]") {
  CHECK(rule("messages.delivery ci < 1%").figure == "messages.delivery");
  CHECK(rule("messages.delivery ci < 1%").limit == Approx(0.01));
  CHECK(rule("messages.delivery ci < 1%").is_relative);
  CHECK(rule("events ci<50").limit == 50);
  CHECK(!rule("events ci<50").is_relative);
  for (const auto* each :
       {"", "events", "events < 5", "ci < 5", " ci < 5", "events ci < ", "events ci < 0",
        "events ci < -1%", "events ci < x", "events ci > 5", "two words ci < 5", "eventsci < 5"})
    CHECK(std::holds_alternative<std::string>(parse_stop_rule(each)));
}

TEST_CASE("looks double up to all runs, and share the usual error", "[study]") {
  const stopping x(rule("events ci < 1"), 100);
  CHECK(x.looks() == std::vector<std::size_t>{8, 16, 32, 64, 100});
  CHECK(x.confidence() == Approx(0.99));
  CHECK(stopping(rule("events ci < 1"), 8).looks() == std::vector<std::size_t>{8});
  CHECK(stopping(rule("events ci < 1"), 3).looks() == std::vector<std::size_t>{3});
  CHECK(stopping(rule("events ci < 1"), 1).confidence() == Approx(0.95));
}

TEST_CASE("a variant has enough runs when it is precise, or has all", "[study]") {
  const stopping x(rule("events ci < 1%"), 20);
  CHECK(x.needed(values{}) == 8);
  CHECK(x.needed(values(8, 10.0)) == 8);
  values spread{1, 2, 3, 4, 5, 6, 7, 8};
  CHECK(x.needed(spread) == 16);
  spread.resize(16, 9);
  CHECK(x.needed(spread) == 20);
  spread.resize(20, 9);
  CHECK(x.needed(spread) == 20);
  CHECK(!x.is_precise(spread));
  CHECK(x.needed(values(8)) == 16); // none has the figure
  CHECK(!stopping(rule("events ci < 1%"), 20).is_precise(values(8, 0.0)));
}

TEST_CASE("intervals at the end of a sequence of looks cover the truth", "[study]") {
  random_stream random(1);
  int covering = 0;
  constexpr int studies = 1000;
  for (int i = 0; i < studies; ++i) {
    const stopping x(rule("a ci < 0.6"), 64);
    values all;
    std::vector<double> known;
    for (auto runs = x.needed(all); runs > all.size(); runs = x.needed(all))
      while (all.size() < runs) {
        known.push_back(5 + random.normal());
        all.emplace_back(known.back());
      }
    const auto found = mean_of(known, x.confidence());
    covering += std::abs(found.mean - 5) <= *found.half_width ? 1 : 0;
  }
  CHECK(covering >= 0.93 * studies);
}
