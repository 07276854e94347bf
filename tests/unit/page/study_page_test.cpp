#include <string>
#include <utility>

#include "page/study_page.hpp"
#include "support/catch.hpp"
#include "support/text.hpp"

using namespace rubicon;
using namespace rubicon::page;
using rubicon::test::contains;

namespace {

study_page two_parameters() {
  study_page x;
  x.file = "home.toml";
  x.command = "rubicon sweep home.toml";
  x.parameters = {"loss", "range"};
  x.variants = {{"0", "15m"}, {"0", "20m"}, {"0.1", "15m"}, {"0.1", "20m"}};
  study_scalar scalar{"messages.delivery", {}, {}};
  for (std::size_t i = 0; i < x.variants.size(); ++i) {
    const auto value = 0.5 + 0.1 * static_cast<double>(i);
    scalar.figures.push_back({2, value, std::pair(value - 0.05, value + 0.05)});
    scalar.runs.push_back({{1, value - 0.01}, {2, value + 0.01}});
  }
  x.scalars.push_back(std::move(scalar));
  x.replay = [](std::size_t variant, std::uint64_t seed) {
    return "replay " + std::to_string(variant) + " <" + std::to_string(seed) + '>';
  };
  return x;
}

std::size_t times(const std::string& text, const std::string& what) {
  std::size_t found = 0;
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + 1))
    ++found;
  return found;
}

} // namespace

TEST_CASE("a study's page has curves over each parameter, a map, and all runs", "[page]") {
  const auto html = html_of(two_parameters());
  CHECK(contains(html, "4 variants · 8 runs · lines are the mean, with 95 % intervals"));
  CHECK(contains(html, "aria-label='messages.delivery over loss'"));
  CHECK(contains(html, "aria-label='messages.delivery over range'"));
  CHECK(contains(html, "range over loss: 0.5"));
  CHECK(contains(html, "loss=0.1 range=20m: 0.8"));
  CHECK(times(html, "<circle") == 8);
  CHECK(contains(html, "replay 0 &lt;1&gt;"));
  CHECK(contains(html, "replay 3 &lt;2&gt;"));
}

TEST_CASE("a study over one parameter has no map", "[page]") {
  auto x = two_parameters();
  x.parameters = {"loss"};
  x.variants = {{"0"}, {"1"}, {"2"}, {"<b>"}};
  const auto html = html_of(x);
  CHECK(!contains(html, "Map of"));
  CHECK(contains(html, "over loss"));
  CHECK(contains(html, "&lt;b&gt;"));
  CHECK(!contains(html, "<b>"));
}

TEST_CASE("variants without results have no place on a study's page", "[page]") {
  auto x = two_parameters();
  for (std::size_t i = 0; i < x.variants.size(); ++i) {
    x.scalars[0].figures[i] = {};
    x.scalars[0].runs[i].clear();
  }
  CHECK(!contains(html_of(x), "<svg"));
  x.scalars.clear();
  CHECK(contains(html_of(x), "0 runs"));
}
