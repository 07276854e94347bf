#include <string>
#include <variant>
#include <vector>

#include "study/grid.hpp"
#include "support/catch.hpp"

using namespace rubicon::study;

namespace {

using texts = std::vector<std::string>;

texts values_of(const std::string& text) {
  const auto found = parse_variation("x=" + text);
  const auto* good = std::get_if<variation>(&found);
  return good == nullptr ? texts{std::get<std::string>(found)} : good->values;
}

} // namespace

TEST_CASE("a list of values is split at its commas", "[study]") {
  CHECK(values_of("0,0.1,0.2") == texts{"0", "0.1", "0.2"});
  CHECK(values_of("csma") == texts{"csma"});
  CHECK(values_of("[0, 1],[2, 3]") == texts{"[0, 1]", "[2, 3]"});
  CHECK(values_of("\"a,b\",c") == texts{"\"a,b\"", "c"});
  CHECK(values_of("{ a = 1, b = 2 }") == texts{"{ a = 1, b = 2 }"});
}

TEST_CASE("a range counts in exact decimals and keeps its unit", "[study]") {
  CHECK(values_of("15m..40m/5") == texts{"15m", "20m", "25m", "30m", "35m", "40m"});
  CHECK(values_of("15m..40m/10m") == texts{"15m", "25m", "35m"});
  CHECK(values_of("0..0.3/0.1") == texts{"0", "0.1", "0.2", "0.3"});
  CHECK(values_of("-0.05..0.05/0.05") == texts{"-0.05", "0", "0.05"});
  CHECK(values_of("1..1/1") == texts{"1"});
  CHECK(values_of("100..300/100") == texts{"100", "200", "300"});
}

TEST_CASE("what is no variation is refused with a reason", "[study]") {
  const std::string no_range =
      "is not a range: give first, last and step in one unit, as in range=15m..40m/5";
  for (const auto* each : {"1..2", "2..1/1", "1..2/0", "1..2/-1", "1m..2s/1", "1m..2m/1s", "..2/1",
                           "1.2.3..4/1", ".5..1/1", "1..9999999999/1", "0..1/0.0000000001"})
    CHECK(values_of(each) == texts{no_range});
  CHECK(values_of("1,,2") == texts{"has an empty value"});
  CHECK(values_of("") == texts{"has an empty value"});
  CHECK(values_of("1,2,1") == texts{"has a value twice"});
  CHECK(values_of("1..10000/1").size() == values_max);
  CHECK(values_of("0..10000/1") == texts{"has more than 10000 values"});
  for (const auto* each : {"", "x", "=1"})
    CHECK(std::holds_alternative<std::string>(parse_variation(each)));
}

TEST_CASE("variants are all combinations of the values", "[study]") {
  const auto found = variants_of({{"a", {"1", "2"}}, {"b", {"x", "y"}}});
  const std::vector<variant_values> all{{"1", "x"}, {"1", "y"}, {"2", "x"}, {"2", "y"}};
  CHECK(std::get<0>(found) == all);
  CHECK(std::get<0>(variants_of({})) == std::vector<variant_values>{{}});
  const variation many{"a", texts(1000, "v")};
  CHECK(std::get<0>(variants_of({many, {"b", texts(100, "v")}})).size() == variants_max);
  CHECK(std::get<1>(variants_of({many, {"b", texts(101, "v")}})) ==
        "there are more than 100000 variants");
}
