#include <string>

#include "page/swarm_page.hpp"
#include "support/catch.hpp"
#include "support/text.hpp"

using namespace rubicon;
using namespace rubicon::page;
using rubicon::test::contains;

TEST_CASE("a swarm's page shows how figures differ between seeds", "[page]") {
  seed_figures figures;
  for (std::uint64_t seed = 1; seed <= 50; ++seed)
    figures.add(seed,
                {{"messages arrived, %", 90 + 0.1 * static_cast<double>(seed)}, {"motes", 7}});
  const std::map<std::string, std::uint64_t> none;
  const auto html = html_of({"home.toml", "1..50", 50, 0, none, figures, {}, "rubicon swarm"});
  CHECK(contains(html, "home.toml, seeds 1..50"));
  CHECK(contains(html, "no violations"));
  CHECK(contains(html, "least 90.10 (seed 1) · median 92.60 (seed 26) · most 95.00 (seed 50)"));
  CHECK(contains(html, "the same with every seed"));
  CHECK_FALSE(contains(html, "<section id='violations'>"));
}

TEST_CASE("a swarm's page shows what was violated, as data", "[page]") {
  const std::map<std::string, std::uint64_t> violations{{"<b>all joined</b>", 3}};
  const std::vector<failed_seed> failed{{19,
                                         {{instant{}, "<b>all joined</b>", "<script>"}},
                                         "rubicon run 'a b.toml' --seed 19",
                                         "loss=0.3, without crash"}};
  const auto html =
      html_of({"<i>.toml", "1..50", 50, 3, violations, seed_figures(), failed, "rubicon swarm"});
  CHECK(contains(html, "3 of 50 runs with violations"));
  CHECK(contains(html, "&lt;b&gt;all joined&lt;/b&gt;"));
  CHECK(contains(html, "rubicon run &#39;a b.toml&#39; --seed 19"));
  CHECK(contains(html, "19 (loss=0.3, without crash)"));
  CHECK(contains(html, "… and more"));
  CHECK_FALSE(contains(html, "<script"));
  CHECK_FALSE(contains(html, "<i>"));
}

TEST_CASE("a swarm's page begins with the figures that matter", "[page]") {
  seed_figures figures;
  for (std::uint64_t seed = 1; seed <= 9; ++seed) {
    const auto x = static_cast<double>(seed);
    figures.add(seed, {{"PEIS packages", 100 + x},
                       {"another figure", x},
                       {"charge used by all motes, mAh", 50 + x},
                       {"messages arrived, %", 90 + 0.1 * x},
                       {"motes joined", 13},
                       {"real time, s", x}});
  }
  const auto html = html_of({"home.toml", "1..9", 9, 0, {}, figures, {}, "rubicon swarm"});
  std::size_t last = 0;
  for (const auto* title : {"messages arrived, %", "charge used by all motes, mAh",
                            "another figure", "PEIS packages", "real time, s", "motes joined"}) {
    const auto at = html.find("<h3>" + std::string(title));
    CAPTURE(title);
    REQUIRE(at != std::string::npos);
    CHECK(at > last);
    last = at;
  }
}

TEST_CASE("figures of very many seeds are bounded", "[page]") {
  seed_figures figures;
  for (std::uint64_t seed = 0; seed < seed_figures::seeds_max + 10; ++seed)
    figures.add(seed, {{"events", 1.0}});
  CHECK(figures.all().at("events").size() == seed_figures::seeds_max);
}

TEST_CASE("a swarm's page shows situations, and which faults runs had", "[page]") {
  const std::map<std::string, std::uint64_t> none;
  const seed_figures figures;
  const std::vector<failed_seed> failed;
  swarm_page x{"home.toml", "1..50", 50, 0, none, figures, failed, "rubicon swarm"};
  CHECK_FALSE(contains(html_of(x), "<section id='coverage'>"));
  x.situations = {{"a <hand-over>", 12, 3}, {"a reboot", 0, std::nullopt}};
  x.faults = {{"crash", 26}};
  const auto html = html_of(x);
  CHECK(contains(html, "<section id='coverage'>"));
  CHECK(contains(html, "a &lt;hand-over&gt;"));
  CHECK(contains(html, "✗ no violations, 1 situation never reached"));
  CHECK(contains(html, "crash"));
  CHECK(contains(html, ">26<"));
}
