#include <sstream>

#include "report/print/text_layout.hpp"
#include "support/catch.hpp"

using namespace rubicon::report;

namespace {

table two_columns() {
  table x({{"name"}, {"count", align::right}});
  x.add({"a", "1"});
  x.add({"longer", "1,000"});
  return x;
}

} // namespace

TEST_CASE("text is measured and cut in characters", "[report]") {
  CHECK(display_width("abc") == 3);
  CHECK(display_width("°C – ×") == 6);
  CHECK(cut("abc", 3) == "abc");
  CHECK(cut("abcd", 3) == "ab…");
  CHECK(cut("°°°°", 3) == "°°…");
  CHECK(cut("abc", 0).empty());
}

TEST_CASE("columns are as wide as their widest cell", "[report]") {
  CHECK(two_columns().render(80, false) == "  name    count\n"
                                           "  a           1\n"
                                           "  longer  1,000\n");
}

TEST_CASE("numbers stand one above the other at their decimal points", "[report]") {
  table x({{"value", align::point}, {"unit"}});
  x.add({"22.3", "C"});
  x.add({"-3.25", "C"});
  x.add({"41", "%"});
  x.add({"on", ""});
  CHECK(x.render(80, false) == "  value  unit\n"
                               "  22.3   C\n"
                               "  -3.25  C\n"
                               "  41     %\n"
                               "  on\n");
}

TEST_CASE("a column without text disappears with its heading", "[report]") {
  table x({{"name"}, {"lost"}, {"count", align::right}});
  x.add({"a", "", "1"});
  CHECK(x.render(80, false) == "  name  count\n"
                               "  a         1\n");
}

TEST_CASE("where space is short text is cut before a column is left out, figures never",
          "[report]") {
  table x({{"name"}, {"count", align::right}, {"rate", align::right}});
  x.add({"a-rather-long-name", "1,000", "99.7%"});
  CHECK(x.render(80, false).find("a-rather-long-name  1,000  99.7%") != std::string::npos);
  CHECK(x.render(26, false).find("  a-rather-…  1,000  99.7%") != std::string::npos);
  CHECK(x.render(20, false).find("  a-rather-l…  1,000\n") != std::string::npos);
  CHECK(x.render(26, false).find("too narrow") == std::string::npos);
  CHECK(x.render(23, false).ends_with("  … too narrow for rate\n"));
}

TEST_CASE("a note stands below its row over all columns", "[report]") {
  auto x = two_columns();
  x.add_note("… and 3 more rows of the same kind");
  const auto text = x.render(20, false);
  CHECK(text.ends_with("  longer  1,000\n  … and 3 more rows…\n"));
}

TEST_CASE("colour changes no column", "[report]") {
  table x({{"name"}, {"count", align::right}});
  x.add({{"a", look::bad}, "1"});
  x.add({"longer", {"22", look::good}});
  auto coloured = x.render(80, true);
  CHECK(coloured != x.render(80, false));
  for (auto from = coloured.find('\033'); from != std::string::npos; from = coloured.find('\033'))
    coloured.erase(from, coloured.find('m', from) + 1 - from);
  CHECK(coloured == x.render(80, false));
}
