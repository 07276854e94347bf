#include <string>
#include <vector>

#include "study/series.hpp"
#include "support/catch.hpp"

using namespace rubicon::study;

using points = std::vector<series_point>;

TEST_CASE("a series is the sum of all rows of a time", "[study]") {
  const std::string csv =
      "time_s,island,mote,used_mah\n20,a,x,0.5\n20,a,y,0.25\n40,a,x,1\n40,a,y,\n";
  CHECK(summed_series(csv, "used_mah", "energy.used_mah") ==
        points{{"energy.used_mah", 20, 0.75}, {"energy.used_mah", 40, 1}});
  CHECK(summed_series(csv, "used_mah", "energy", {"mote"}) ==
        points{{"energy.x", 20, 0.5}, {"energy.x", 40, 1}, {"energy.y", 20, 0.25}});
}

TEST_CASE("fields of a table may be quoted", "[study]") {
  CHECK(summed_series("time_s,cause,lost\n1,\"a, \"\"b\"\"\",2\r\n", "lost", "n", {"cause"}) ==
        points{{"n.a, \"b\"", 1, 2}});
}

TEST_CASE("what is no table of times has no series", "[study]") {
  CHECK(summed_series("", "lost", "n").empty());
  CHECK(summed_series("lost\n3\n", "lost", "n").empty());
  CHECK(summed_series("time_s\n3\n", "lost", "n").empty());
  CHECK(summed_series("time_s,lost\n1,2\n", "lost", "n", {"layer"}).empty());
  CHECK(summed_series("time_s,lost\n1\nx,2\n3,nan\n4,5,6\n7,8", "lost", "n") ==
        points{{"n", 7, 8}});
}
