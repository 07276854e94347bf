#include <string>
#include <vector>

#include "cli/study/sweep_text.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::cli;

namespace {

const std::string report = R"({"interrupted": false, "seed": 7, "events": 12, "complete": true,
  "messages": {"delivery": 0.75, "spread": [1, 2], "deep": {"sum": 3}}, "energy": {"used_mah": null},
  "expectations": [{"expect": "delivery >= 99%", "met": false, "measured": "75%"},
                   {"expect": "tuple a", "met": null, "measured": ""}],
  "violations": [{"at_s": 1.5, "invariant": "rule", "detail": "broken"}]})";

study_summary two_variants() {
  return {{"loss"},
          {{"0"}, {"0.5"}},
          {{"messages.delivery", {{10, 20, 30}, {9, 19, std::nullopt}}}},
          std::nullopt};
}

} // namespace

TEST_CASE("a result has the numbers of a report by their paths", "[cli]") {
  const auto x = result_of(report);
  REQUIRE(x.has_value());
  const std::map<std::string, double> scalars{
      {"events", 12}, {"messages.delivery", 0.75}, {"messages.deep.sum", 3}, {"violations", 1}};
  CHECK(x->scalars == scalars);
  REQUIRE(x->expectations.size() == 2);
  CHECK(x->expectations[0].met == false);
  CHECK(!x->expectations[1].met);
  REQUIRE(x->violations.size() == 1);
  CHECK(x->violations[0].detail == "broken");
}

TEST_CASE("what is no report of a whole run has no result", "[cli]") {
  for (const auto* each : {"", "{", "[]", "{}", R"({"interrupted": true})",
                           R"({"interrupted": false, "expectations": 3, "violations": []})"})
    CHECK(!result_of(each));
}

TEST_CASE("a summary compares variants seed by seed", "[cli]") {
  const auto text = summary_text(two_variants(), 120, false);
  CAPTURE(text);
  CHECK(text.starts_with("messages.delivery\n"));
  CHECK(text.find("20.000") != std::string::npos);
  CHECK(text.find("-4.8414 to 44.841") != std::string::npos); // 10 * 4.302653 / sqrt(3)
  CHECK(text.find("-1.0000         -1.0000 to -1.0000") != std::string::npos);
}

TEST_CASE("a summary as CSV has a line for each scalar and variant", "[cli]") {
  const auto text = summary_csv(two_variants());
  CAPTURE(text);
  CHECK(
      text.starts_with("loss,scalar,runs,mean,low,high,difference,difference_low,difference_high\n"
                       "0,messages.delivery,3,20,-4.84"));
  CHECK(text.find("\n0.5,messages.delivery,2,14,") != std::string::npos);
  CHECK(text.ends_with(",-1,-1,-1\n"));
}

TEST_CASE("a variant without results has empty fields", "[cli]") {
  auto x = two_variants();
  x.scalars[0].of_variants[1] = {std::nullopt, std::nullopt, std::nullopt};
  CHECK(summary_csv(x).ends_with("\n0.5,messages.delivery,0,,,,,,\n"));
}

TEST_CASE("a summary of a quantile has its bootstrap interval", "[cli]") {
  auto x = two_variants();
  x.quantile = 0.5;
  const auto text = summary_text(x, 120, false);
  CAPTURE(text);
  CHECK(text.find("50 % quantile") != std::string::npos);
  CHECK(text.find("10.000 to 30.000") != std::string::npos);
  CHECK(text.find("-1.0000         -1.0000 to -1.0000") != std::string::npos);
  CHECK(summary_csv(x).starts_with("loss,scalar,runs,quantile,low,high,"));
}

TEST_CASE("a summary has the confidence of its intervals", "[cli]") {
  auto x = two_variants();
  x.confidence = 0.9875;
  CHECK(summary_text(x, 120, false).find("98.75 % interval") != std::string::npos);
}
