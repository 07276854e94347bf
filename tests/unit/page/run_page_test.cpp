#include <limits>
#include <string>

#include "page/run_page.hpp"
#include "support/catch.hpp"
#include "support/text.hpp"
#include "unit/report/sample.hpp"

using namespace rubicon;
using namespace rubicon::report;
using rubicon::test::contains;
using rubicon::test::large_report;
using rubicon::test::sample_report;

namespace {

/// Where the motes of the sample report are.
config::ecology_description sample_ecology(const run_report& of) {
  config::ecology_description x;
  x.name = of.ecology;
  for (const auto& island : of.islands) {
    config::island_description to;
    to.id = island.id;
    to.name = island.name;
    for (const auto& mote : island.motes) {
      config::mote_description each;
      each.id = mote.address.mote;
      each.name = mote.name;
      each.place = {2.0 * mote.address.mote.value, 1.0 * island.id.value, 0};
      to.motes.push_back(each);
    }
    x.airs.push_back({island.name, {island.id}});
    x.islands.push_back(std::move(to));
  }
  return x;
}

std::string page_of(const run_report& x, const history& seen = {}) {
  return page::html_of({sample_ecology(x), x, seen, "rubicon run a.toml --seed 42", "00ff"});
}

/// Values of attributes are texts.
std::string without_values(const std::string& tag) {
  std::string names;
  char quote = 0;
  for (const char c : tag) {
    if (quote == 0)
      names += c;
    if (quote == 0 && (c == '\'' || c == '"'))
      quote = c;
    else if (c == quote)
      quote = 0;
  }
  CHECK(quote == 0);
  return names;
}

/// Every element is closed in the order in which they were opened, and none runs or loads anything.
void check_well_formed(const std::string& html) {
  std::vector<std::string> open;
  for (auto from = html.find('<'); from != std::string::npos; from = html.find('<', from)) {
    const auto end = html.find('>', from);
    REQUIRE(end != std::string::npos);
    const auto tag = without_values(html.substr(from + 1, end - from - 1));
    from = end;
    if (tag.starts_with('!') || tag.starts_with("meta"))
      continue;
    const auto name = tag.substr(0, tag.find_first_of(" /", 1));
    CAPTURE(tag);
    if (tag.starts_with('/')) {
      REQUIRE_FALSE(open.empty());
      CHECK(name == '/' + open.back());
      open.pop_back();
    } else if (!tag.ends_with('/')) {
      open.push_back(name);
    }
    for (const auto* word : {"script", "iframe", "object", "embed", "link", "img", "image", "base",
                             "form", "input", "a", "use", "foreignObject"})
      CHECK(name != word);
    CHECK_FALSE(contains(tag, " on"));
    for (const auto* word : {"src=", "href=", "srcset=", "action="})
      CHECK_FALSE(contains(tag, word));
  }
  CHECK(open.empty());
  for (const auto* word : {"://", "url(", "@import"})
    CHECK_FALSE(contains(html, word));
}

} // namespace

TEST_CASE("tables and titles of a page have labels beside names", "[page]") {
  const auto x = sample_report();
  auto ecology = sample_ecology(x);
  using kind = config::label_table::kind;
  const auto& island = x.islands.front();
  const auto mote = island.name + '/' + island.motes.front().name;
  ecology.labels.add(kind::mote, mote, "Herd <1>");
  ecology.labels.add(kind::peer, x.peers.front().name, "PC im Flur");
  ecology.labels.add(kind::proxy, x.proxies.front().proxy_class, "Klima");
  const auto html = page::html_of({ecology, x, {}, "", ""});
  CHECK(contains(html, "<td class='name'>" + mote + " (Herd &lt;1&gt;)</td>"));
  CHECK(contains(html, "<title>" + mote + " (Herd &lt;1&gt;)"));
  CHECK(contains(html, x.peers.front().name + " (PC im Flur)"));
  CHECK(contains(html, x.proxies.front().name + " (Klima)"));
}

TEST_CASE("drawings of a page have labels beside names", "[page]") {
  auto x = sample_report();
  auto ecology = sample_ecology(x);
  using kind = config::label_table::kind;
  ecology.labels.add(kind::island, "kitchen", "Küche & Flur");
  ecology.labels.add(kind::mote, "kitchen/climate-7", "Herd");
  ecology.labels.add(kind::peer, "robot", "Putzroboter im Obergeschoss");
  x.event_log.push_back({instant{1s}, "kitchen/climate-7 and 3 others", "joined"});
  x.event_log.push_back({instant{2s}, "robot/collector-1", "started again"});
  x.event_log.push_back({instant{3s}, "kitchen.climate-7.temperature", "deleted"});
  history seen;
  for (int i = 1; i <= 3; ++i) {
    run_sample sample;
    sample.at = instant{i * 60s};
    auto& to = sample.motes.emplace_back();
    to.address = x.islands.front().motes.front().address;
    to.used_mah = 0.1 * i;
    seen.add(sample);
    seen.add(tuple_write{sample.at, "robot", "robot", "kitchen.climate-7.temperature",
                         std::to_string(i), false});
  }
  const auto html = page::html_of({ecology, x, seen, "", ""});
  check_well_formed(html);
  SECTION("the map names an island and its places") {
    CHECK(contains(html, "text-anchor='start'>kitchen (Küche &amp; Flur)</text>"));
    CHECK(contains(html, "Map of kitchen (Küche &amp; Flur)"));
    CHECK(contains(html, "<title>kitchen (Küche &amp; Flur)/sink</title>"));
    CHECK(contains(html, ">climate-7 (Herd)</text>"));
    CHECK(contains(html, "<title>kitchen/climate-7 (Herd): 97.3% of its messages arrived</title>"));
  }
  SECTION("the time line names lanes, whole where they are cut, and events") {
    CHECK(contains(html, "kitchen (Küche &amp; Fl…<title>kitchen (Küche &amp; Flur)</title>"));
    CHECK(contains(html, "<title>robot (Putzroboter im Obergeschoss)</title>"));
    CHECK(contains(html, "kitchen/climate-7 (Herd) and 3 others  joined"));
    CHECK(contains(html, "<td class='name'>robot (Putzroboter im Obergeschoss)/collector-1</td>"));
    CHECK(contains(html, "<td class='name'>kitchen.climate-7.temperature (Herd)</td>"));
  }
  SECTION("curves name motes") {
    CHECK(contains(html, "kitchen/climate-7 (Herd), 0.300 mAh"));
    CHECK(contains(html, "kitchen.climate-7.temperature (Herd)  (robot, 3 values"));
  }
}

TEST_CASE("a page shows the run and needs nothing else", "[page]") {
  const auto html = page_of(sample_report());
  check_well_formed(html);
  CHECK(html.starts_with("<!doctype html>"));
  CHECK(contains(html, "content=\"default-src 'none'; style-src 'unsafe-inline'\""));
  CHECK(contains(html, "<h1>two rooms</h1>"));
  CHECK(contains(html, "no violations"));
  CHECK(contains(html, "rubicon run a.toml --seed 42"));
  for (const auto* id : {"expectations", "map", "time", "losses", "motes", "proxies", "peers"})
    CHECK(contains(html, std::string("<section id='") + id + "'>"));
  CHECK(contains(html, "prefers-color-scheme:dark"));
  CHECK(contains(html, "name='viewport'"));
}

TEST_CASE("the map shows motes, the way to their parents, and who has no power", "[page]") {
  const auto html = page_of(sample_report());
  CHECK(contains(html, "<title>kitchen/climate-7: 97.3% of its messages arrived</title>"));
  CHECK(contains(html, "class='link fair'><title>kitchen/climate-7"));
  CHECK(contains(html, "kitchen/lamp-9, battery"));
  CHECK(contains(html, "class='mote absent'><title>living-room/blinds-3, never joined"));
}

TEST_CASE("the table of motes begins with the worst", "[page]") {
  const auto html = page_of(sample_report());
  const auto worst = html.find("<td class='name'>kitchen/climate-7</td>");
  const auto other = html.find("<td class='name'>living-room/climate-2</td>");
  REQUIRE(worst != std::string::npos);
  REQUIRE(other != std::string::npos);
  CHECK(worst < other);
  CHECK(contains(html, "<td class='fair number'>97.3%</td><td class='long'>gave_up 2, crowded "
                       "1</td><td>climate-8</td>"));
}

TEST_CASE("an expectation that is not met is told once, with its command, and on the time line",
          "[page]") {
  auto x = sample_report();
  x.expectations[0].outcome = expectation_report::verdict::unmet;
  x.expectations[0].command = "rubicon explain run.rec --lost";
  x.violations = {{instant{20s}, "expected: joined within 20 s", "5 motes"}};
  auto html = page_of(x);
  check_well_formed(html);
  CHECK(contains(html, "1 violation"));
  CHECK(contains(html, "<td class='unmet'>✗</td><td class='long'>joined within 20 s</td>"));
  CHECK(contains(html, "rubicon explain run.rec --lost"));
  CHECK(contains(html, "<title>0:20.000  expected: joined within 20 s: 5 motes</title>"));
  CHECK_FALSE(contains(html, "<section id='violations'>"));
  x.violations.push_back({instant{}, "radio copies balance", "sent 1, delivered 0"});
  html = page_of(x);
  CHECK(contains(html, "<section id='violations'>"));
  CHECK(contains(html, "<td class='long bad'>radio copies balance</td>"));
}

TEST_CASE("the first violation comes first, with what had happened until then", "[page]") {
  auto x = sample_report();
  CHECK_FALSE(contains(page_of(x), "<section id='first'>"));
  x.event_log = {{instant(1s), "kitchen/climate-7", "joined"},
                 {instant(19s), "kitchen/climate-7", "left: battery"},
                 {instant(30s), "kitchen/climate-8", "joined"}};
  x.violations = {{instant{40s}, "radio copies balance", "sent 1, delivered 0"},
                  {instant{20s}, "motes stay", "<b>1 left</b>"}};
  auto ecology = sample_ecology(x);
  ecology.faults.push_back({10s, config::unplug_fault{x.islands[0].id}});
  ecology.faults.push_back({25s, config::unplug_fault{x.islands[0].id}});
  const auto html = page::html_of({ecology, x, {}, "rubicon run a.toml", "00ff"});
  check_well_formed(html);
  const auto first = html.substr(html.find("<section id='first'>"));
  const auto section = first.substr(0, first.find("</section>"));
  CHECK(contains(section, "0:20.000  motes stay: &lt;b&gt;1 left&lt;/b&gt;"));
  CHECK(contains(section, "Newest fault before it: 0:10.000"));
  CHECK(contains(section, "left: battery"));
  CHECK_FALSE(contains(section, "climate-8"));
  CHECK(html.find("<section id='first'>") < html.find("<section id='violations'>"));
}

TEST_CASE("flows between more than 30 motes are a matrix", "[page]") {
  auto x = sample_report();
  const auto flows_of = [&x](int senders) {
    x.flows.clear();
    for (int i = 0; i < senders; ++i) {
      auto& flow = x.flows.emplace_back();
      flow.from_name = "lab/node-" + std::to_string(i);
      flow.to_name = "lab/sink";
      flow.sent = 100;
      flow.pdr = i == 7 ? 0.5 : 1;
    }
    return page_of(x);
  };
  CHECK_FALSE(contains(flows_of(29), "<section id='matrix'>"));
  const auto html = flows_of(30);
  check_well_formed(html);
  CHECK(contains(html, "<section id='matrix'>"));
  CHECK(contains(html, "lab/node-7 to lab/sink: 50.0% of 100 packets delivered"));
  x.flows[7].to_name = "lab/*"; // a broadcast has no one receiver
  CHECK_FALSE(contains(page_of(x), "lab/node-7 to"));
}

TEST_CASE("a place of losses says when most of its cause were lost", "[page]") {
  auto x = sample_report();
  x.simulated = 100s;
  x.losses = {{"message", "gave_up", "kitchen/climate-7", 3}};
  history seen;
  for (int i = 0; i <= 10; ++i) {
    run_sample sample;
    sample.at = instant(i * 10s);
    island_sample island;
    island.island = x.islands[0].id;
    island.lost["messages"]["gave_up"] = i < 5 ? 1 : 4;
    sample.islands.push_back(island);
    seen.add(sample);
  }
  CHECK(contains(page_of(x, seen), "0:40.000 to 0:50.000, 75.0%"));
  CHECK(contains(page_of(x), "kitchen/climate-7")); // without samples the time is not known
}

TEST_CASE("names and values of others are data on a page", "[page]") {
  const std::string evil = "<script src='http:x'>alert(1)</script>\033[2J\"'><img onerror=x>&\xff";
  auto x = sample_report();
  x.ecology = evil;
  x.islands[0].name = evil;
  x.islands[0].motes[0].name = evil;
  x.islands[0].motes[0].left_cause = evil;
  x.islands[0].radio.lost[evil] = 3;
  x.peers[0].name = evil;
  x.peers[0].peis.lost[evil] = 1;
  x.proxies[0].name = evil;
  x.proxies[0].values[0] = {evil, evil};
  x.event_log[0].who = evil;
  x.event_log[0].what = evil;
  x.violations = {{instant{}, evil, evil}};
  x.expectations[0].text = evil;
  x.expectations[0].measured = evil;
  x.expectations[0].command = evil;
  x.reason = evil;
  history seen;
  for (int i = 0; i < 4; ++i)
    seen.add(tuple_write{instant{i * 1s}, evil, evil, evil, std::to_string(i), false});
  const auto html = page::html_of({sample_ecology(x), x, seen, evil, evil});
  check_well_formed(html);
  CHECK_FALSE(contains(html, "<script"));
  CHECK_FALSE(contains(html, "\033"));
  CHECK(contains(html, "&lt;script src=&#39;http:x&#39;&gt;alert(1)&lt;/script&gt;"));
}

TEST_CASE("curves show what samples and tuples have told", "[page]") {
  const auto x = sample_report();
  history seen;
  for (int i = 1; i <= 10; ++i) {
    run_sample sample;
    sample.at = instant{i * 60s};
    for (const auto& island : x.islands)
      for (const auto& mote : island.motes) {
        auto& to = sample.motes.emplace_back();
        to.address = mote.address;
        to.alive = true;
        to.used_mah = 0.1 * i;
        to.battery_mah = 2500;
      }
    for (const auto& island : x.islands)
      sample.islands.push_back(
          {island.id,
           {{"radio", {{"collision", static_cast<std::uint64_t>(i)}, {"filtered", 900}}}}});
    seen.add(sample);
    seen.add(tuple_write{sample.at, "robot", "robot", "robot.speed", std::to_string(i), false});
    seen.add(tuple_write{sample.at, "robot", "robot", "robot.name", "r2", false});
  }
  const auto html = page_of(x, seen);
  check_well_formed(html);
  CHECK(contains(html, "<section id='energy'>"));
  CHECK(contains(html, "kitchen/climate-7, 1.000 mAh"));
  CHECK(contains(html, "robot.speed  (robot, 10 values, the last 10.00)"));
  CHECK_FALSE(contains(html, "robot.name"));
  CHECK(contains(html, "aria-label='Losses over time'"));
  CHECK(contains(html, "</svg>\ncollision</span>"));
  CHECK_FALSE(contains(html, "</svg>\nfiltered</span>"));
}

TEST_CASE("a large run folds what is long and says so", "[page]") {
  const auto html = page_of(large_report());
  check_well_formed(html);
  CHECK(contains(html, "… and 960 more motes"));
  CHECK(contains(html, "… and 26 more places"));
  CHECK(contains(html, "600 between them are omitted"));
}

TEST_CASE("nothing to show is no section", "[page]") {
  const auto html = page_of(run_report{});
  check_well_formed(html);
  CHECK_FALSE(contains(html, "<section"));
  CHECK(contains(html, "not complete"));
}

TEST_CASE("groups of motes have a table, which folds what is long", "[page][smepp]") {
  auto x = large_report();
  CHECK_FALSE(contains(page_of(x), "<section id='groups'>"));
  for (auto& island : x.islands) {
    island.smepp.programs = 20;
    island.smepp.members = 20;
    island.smepp.events_raised = 1'234;
    island.smepp.events_lost["gave_up"] = 3;
  }
  x.islands[0].smepp.members = 19;
  const auto html = page_of(x);
  check_well_formed(html);
  CHECK(contains(html, "<section id='groups'>"));
  CHECK(contains(html, "<td class='bad number'>19 of 20</td>"));
  CHECK(contains(html, "<td class='number'>1,234</td>"));
  CHECK(contains(html, "<td class='long'>gave_up 3</td>"));
  CHECK(contains(html, "… and 10 more islands"));
}
