// Where mistakes in imported files are.
#include "unit/imports/shapes.hpp"

using namespace rubicon;
using namespace rubicon::imports;

TEST_CASE("mistakes in an imported file have a line and a column", "[imports]") {
  const auto place = [](format from, std::string_view text) {
    return shapes::refused(from, text).substr(0, 5);
  };
  CHECK(place(format::setdest, "$node_(0) set X_ wide\n") == "1:18:");
  CHECK(place(format::zep, "A B 1\nA C 2\n") == "2:5: ");
  CHECK(place(format::k7, "{}\ndatetime,src,dst,pdr\n2018-01-11 25:00:00,a,b,1\n") == "3:1: ");
  CHECK(place(format::otns, "nodes:\n  - id: 1\n    pos: [1, x]\n") == "3:14:");
  CHECK(place(format::iotlab, "[{]").substr(0, 2) == "1:");
  CHECK(place(format::cooja, "<simconf>\n</simconf>\n").substr(0, 2) == "1:");
}
