// Files of other simulators and testbeds, as ecologies.
#include <string>
#include <string_view>
#include <variant>

#include "imports/plan.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::imports;

namespace {

imported taken(format from, std::string_view text) {
  auto x = import_text(from, text);
  REQUIRE(std::holds_alternative<imported>(x));
  return std::get<imported>(std::move(x));
}

text_place refused(format from, std::string_view text) {
  const auto x = import_text(from, text);
  REQUIRE(std::holds_alternative<import_problem>(x));
  return std::get<import_problem>(x).at;
}

} // namespace

TEST_CASE("a mote of setdest that turns on its route has a corner there", "[imports]") {
  const auto x = taken(format::setdest, "$node_(0) set X_ 5.0\n$node_(0) set Y_ 2.0\n"
                                        "$ns_ at 10.0 \"$node_(0) setdest 15.0 2.0 2.5\"\n"
                                        "$ns_ at 12.0 \"$node_(0) setdest 10.0 12.0 1.0\"\n");
  const auto& path = x.plan.motes.at(0).path;
  REQUIRE(path.size() == 3);
  CHECK(path[0] == std::pair<duration, point>(10s, {5, 2, 0}));
  CHECK(path[1] == std::pair<duration, point>(12s, {10, 2, 0}));
  CHECK(path[2] == std::pair<duration, point>(22s, {10, 12, 0}));
}

TEST_CASE("ratios of a K7 trace change over time", "[imports]") {
  const auto x = taken(format::k7, "{\"location\": \"hall\"}\ndatetime,src,dst,mean_rssi,pdr\n"
                                   "2018-01-11 16:32:15,a,b,-70,0.9\n"
                                   "2018-01-11 16:34:15,a,b,-70,0.25\n");
  REQUIRE(x.plan.changes.size() == 1);
  CHECK(x.plan.changes[0].at == 2min);
  CHECK(x.plan.changes[0].loss == 0.75);
}

TEST_CASE("a file of OTNS needs nodes only", "[imports]") {
  const auto x = taken(format::otns, "nodes:\n  - id: 1\n    pos: [1, 2]\n");
  REQUIRE(x.plan.motes.size() == 1);
  CHECK(x.plan.motes[0].place == point{1, 2, 0});
}

TEST_CASE("mistakes in an imported file have a line and a column", "[imports]") {
  CHECK(refused(format::setdest, "$node_(0) set X_ wide\n") == text_place{1, 18});
  CHECK(refused(format::zep, "A B 1\nA C 2\n") == text_place{2, 5});
  CHECK(refused(format::k7, "{}\ndatetime,src,dst,pdr\n2018-01-11 25:00:00,a,b,1\n") ==
        text_place{3, 1});
  CHECK(refused(format::otns, "nodes:\n  - id: 1\n    pos: [1, x]\n") == text_place{3, 14});
  CHECK(refused(format::iotlab, "[{]").line == 1);
  CHECK(refused(format::cooja, "<simconf>\n</simconf>\n").line == 1);
}
