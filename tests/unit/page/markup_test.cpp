#include <cmath>
#include <limits>

#include "page/axis.hpp"
#include "page/markup.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::page;

namespace {

std::vector<std::string> labels_of(const std::vector<tick>& all) {
  std::vector<std::string> labels;
  for (const auto& x : all)
    labels.push_back(x.label);
  return labels;
}

} // namespace

TEST_CASE("whatever a text says, it is no markup", "[page]") {
  CHECK(escaped("<script>alert('x' & \"y\")</script>") ==
        "&lt;script&gt;alert(&#39;x&#39; &amp; &quot;y&quot;)&lt;/script&gt;");
  CHECK(escaped("a\nb\033[2J\xff") == "a\\nb\\x1b[2J\\xff");
  CHECK(element("td", "<b>", "class='name'") == "<td class='name'>&lt;b&gt;</td>");
}

TEST_CASE("titles and texts of drawings are escaped", "[page]") {
  drawing x(10, 20, "role='img'");
  x.circle({1, 2}, 3, "class='mote'", "<i>");
  x.text({4, 5}, "class='soft'", "a&b");
  const auto svg = x.finish();
  CHECK(svg.starts_with("<svg role='img' viewBox='0 0 10.0 20.0'>"));
  CHECK(svg.find("<circle cx='1.0' cy='2.0' r='3.0' class='mote'><title>&lt;i&gt;</title>") !=
        std::string::npos);
  CHECK(svg.find(">a&amp;b</text>") != std::string::npos);
  CHECK(svg.ends_with("</svg>\n"));
}

TEST_CASE("what is not finite is drawn nowhere", "[page]") {
  CHECK(px(std::numeric_limits<double>::quiet_NaN()) == "-");
  CHECK(px(std::numeric_limits<double>::infinity()) == "-");
  CHECK(px(1.25) == "1.2");
}

TEST_CASE("ticks stand at round numbers", "[page]") {
  CHECK(labels_of(ticks(0, 10, 5)) == std::vector<std::string>{"0", "2", "4", "6", "8", "10"});
  CHECK(labels_of(ticks(0.13, 0.31, 2)) == std::vector<std::string>{"0.2", "0.3"});
  CHECK(labels_of(ticks(-1, 1, 2)) == std::vector<std::string>{"-1", "0", "1"});
  CHECK(ticks(1, 1, 5).empty());
  CHECK(ticks(0, std::numeric_limits<double>::infinity(), 5).empty());
}

TEST_CASE("ticks of time stand at round times of a clock", "[page]") {
  CHECK(labels_of(time_ticks(12min, 4)) == std::vector<std::string>{"0:00", "5:00", "10:00"});
  CHECK(labels_of(time_ticks(24h, 4)) ==
        std::vector<std::string>{"0:00", "6:00:00", "12:00:00", "18:00:00", "24:00:00"});
  CHECK(labels_of(time_ticks(1s, 2)) == std::vector<std::string>{"0.0 s", "0.5 s", "1.0 s"});
  CHECK(time_ticks(365 * 24h, 10).size() < 20);
}
