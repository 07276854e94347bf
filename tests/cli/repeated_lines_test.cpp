#include "cli/print/repeated_lines.hpp"

#include <string>

#include "support/catch.hpp"

using namespace rubicon::cli;
using verdict = repeated_lines::verdict;

TEST_CASE("of lines that are equal but for their time three are shown", "[cli]") {
  repeated_lines x;
  CHECK(x.next("1.000000 E a failed") == verdict::shown);
  CHECK(x.next("2.000000 E a failed") == verdict::shown);
  CHECK(x.next("2.000000 E b failed") == verdict::shown);
  CHECK(x.next("3.000000 E a failed") == verdict::last);
  CHECK(x.next("4.000000 E a failed") == verdict::left_out);
  CHECK(x.next("4.000000 E b failed") == verdict::shown);
  CHECK(x.next("5.000000 E a failed") == verdict::left_out);
}

TEST_CASE("lines beyond those that are counted are all shown", "[cli]") {
  repeated_lines x;
  for (std::size_t i = 0; i < repeated_lines::known_max; ++i)
    CHECK(x.next("1 E " + std::to_string(i)) == verdict::shown);
  for (int i = 0; i < 5; ++i)
    CHECK(x.next("2 E another") == verdict::shown);
  CHECK(x.next("3 E 0") == verdict::shown);
  CHECK(x.next("4 E 0") == verdict::last);
}

TEST_CASE("lines without a time or without text are lines, too", "[cli]") {
  repeated_lines x;
  for (const auto expected : {verdict::shown, verdict::shown, verdict::last, verdict::left_out})
    CHECK(x.next("") == expected);
  CHECK(x.next("word") == verdict::left_out); // a time alone
}
