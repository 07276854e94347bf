// What is judged all through a run, what a mote may be silent for, and times that go on after 2038.
#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "ecology/ecology_files.hpp"
#include "report/invariants.hpp"
#include "support/catch.hpp"
#include "support/seeds.hpp"

using namespace rubicon;
using namespace rubicon::test;

namespace {

constexpr const char* two_motes = R"(
[mote_type.probe]
type = 100
transducers.temperature = { model = "constant", value = 20 }
apps = [{ app = "sampler", transducers = ["temperature"], every = "30s", stamped = true }]
[[island]]
id = 1
name = "hall"
mote = [{ id = 2, type = "probe", position_m = [5, 0] }, { id = 3, type = "probe", position_m = [0, 5] }]
)";

/// `hall/probe-2` and the sink do not hear each other, nor does the other mote hear the first.
std::string cut(const char* from, const char* to) {
  std::string toml;
  const auto link = [&toml](const char* at, const char* a, const char* b, int loss) {
    toml += std::string("[[change]]\nat = \"") + at + "\"\nkind = \"link\"\nfrom = \"hall/" + a +
            "\"\nto = \"hall/" + b + "\"\nloss = " + std::to_string(loss) + "\n";
  };
  for (const auto* other : {"sink", "probe-3"}) {
    link(from, "probe-2", other, 1);
    link(from, other, "probe-2", 1);
    link(to, "probe-2", other, 0);
    link(to, other, "probe-2", 0);
  }
  return toml;
}

std::vector<std::string> lines_of(const std::string& path) {
  std::vector<std::string> lines;
  std::ifstream in(path);
  for (std::string line; std::getline(in, line);)
    lines.push_back(line);
  return lines;
}

} // namespace

TEST_CASE("a mote that is silent for hours is a violation, though it is back at the end",
          "[ecology][report]") {
  const auto what = describe(std::string("[ecology]\nname = \"cut\"\nduration = \"6h\"\n") +
                             two_motes + cut("1h", "4h"));
  for (std::uint64_t seed = 1; seed <= seeds(2); ++seed) {
    CAPTURE(seed);
    const auto report = run(what, seed);
    CHECK(report.motes_left() == 0);
    REQUIRE(report.violations.size() == 1);
    const auto& found = report.violations[0];
    CHECK(found.invariant == report::nobody_is_silent);
    CHECK(found.at < instant{1h + 5min});
    CHECK(found.detail.starts_with("hall/probe-2 was silent for 2 h 5"));
    const auto& motes = report.islands.at(0).motes;
    CHECK(motes.at(0).silence > 2h + 50min);
    CHECK(motes.at(0).silence < 3h + 2min);
    CHECK(motes.at(0).silence_from > instant{1h});
    CHECK(motes.at(1).silence < 1min);
    CHECK(report.islands.at(0).clock.judged > 3600);
    CHECK(report.islands.at(0).clock.outside == 0);
    CHECK(report::to_text(report).find("silent: probe-2 for ") != std::string::npos);
    CHECK(report::to_json(report).find("\"silence_s\"") != std::string::npos);
  }
}

TEST_CASE("a mote that reports each ten minutes is gone after three of these",
          "[ecology][DIS-06]") {
  auto what =
      describe(std::string("[ecology]\nname = \"fades\"\nduration = \"90min\"\n") + two_motes +
               "[[fault]]\nat = \"30min\"\nkind = \"crash\"\nmote = \"hall/probe-2\"\n"
               "for = \"2d\"\n");
  for (auto& mote : what.islands.at(0).motes)
    std::get<config::sampler_app>(mote.apps.edit().at(0)).every = 10min;
  const auto report = run(what);
  const auto left = std::ranges::find_if(report.event_log, [](const auto& x) {
    return x.who == "hall/probe-2" && x.what == "left: silence";
  });
  REQUIRE(left != report.event_log.end());
  // Its last message came at most 10 min before it died.
  CHECK(left->at >= instant{50min});
  CHECK(left->at <= instant{60min + 1s});
}

TEST_CASE("motes whose radios sleep for as long as `keep_alive` stay",
          "[ecology][DIS-06][NRG-01]") {
  const auto what = describe(std::string("[ecology]\nname = \"sleeps\"\nduration = \"50min\"\n") +
                             "[radio]\nloss = \"2%\"\n" + two_motes +
                             "keep_alive = \"10s\"\n"
                             "duty_cycle = { period = \"10s\", window = \"100ms\" }\n");
  for (std::uint64_t seed = 1; seed <= seeds(3); ++seed) {
    CAPTURE(seed);
    const auto report = run(what, seed);
    CHECK(report.violations.empty());
    CHECK(std::ranges::none_of(report.event_log,
                               [](const auto& x) { return x.what.starts_with("left"); }));
  }
}

TEST_CASE("a mote whose radio sleeps says that it searches ever more rarely, and when it is back",
          "[ecology][CLK-01][NRG-01]") {
  const std::string who = "hall/probe-2";
  const std::string rests =
      "finds no neighbour that knows the time: sleeps, and searches less and less often";
  const std::string knows = "knows the time again, after resting for ";
  const auto what =
      describe(std::string("[ecology]\nname = \"away\"\nduration = \"40min\"\n") + two_motes +
               "keep_alive = \"60s\"\n"
               "duty_cycle = { period = \"4s\", window = \"200ms\" }\n" +
               cut("10min", "25min"));
  for (std::uint64_t seed = 1; seed <= seeds(2); ++seed) {
    CAPTURE(seed);
    const auto log = run(what, seed).event_log;
    const auto first =
        std::ranges::find_if(log, [&](const auto& x) { return x.who == who && x.what == rests; });
    REQUIRE(first != log.end());
    CHECK(first->at > instant{10min});
    CHECK(first->at < instant{15min});
    const auto back = std::ranges::find_if(
        log, [&](const auto& x) { return x.who == who && x.what.starts_with(knows); });
    REQUIRE(back != log.end());
    CHECK(back->at > instant{25min});
    CHECK(back->at < instant{32min});
    CHECK(std::ranges::count(log, rests, &report::logged_event::what) == 1); // nor any other mote
  }
}

TEST_CASE("time goes on when it has more than 32 bits of seconds", "[ecology][CLK-06][CLK-08]") {
  const std::string file = "heals-2038.csv";
  const auto what = describe(
      "[ecology]\nname = \"later\"\nduration = \"20min\"\ndate = \"2038-01-19\"\nstart = "
      "\"03:04\"\n" +
      std::string(two_motes) +
      "gateway.apps = [{ app = \"recorder\", streams = [1], every = \"10s\", file = \"" + file +
      "\" }]\n[[peer]]\nid = 300\nname = \"pc\"\nlinks = [\"inproc://hall-gateway\"]\n"
      "apps = [{ app = \"proxy_manager\" }]\n"
      "[[proxy]]\nname = \"probe\"\ntypes = [100]\n"
      "[[proxy.field]]\nname = \"time\"\nchannel = 1\noffset = 2\nencoding = \"u32\"\n"
      "scale = 0.001\ndecimals = 3\n"
      "[[fault]]\nat = \"15min\"\nkind = \"clock_step\"\npeer = \"pc\"\nby = \"100s\"\n");
  auto with_stream = what;
  with_stream.islands.at(0).motes.at(1).apps.edit().emplace_back(apps::app_config(
      apps::stream_writer_config{.every = 10s, .to = {island_id{1}, no_mote}, .stream = 1}));
  const auto report = run(with_stream);
  CHECK(report.violations.empty());
  CHECK(report.islands.at(0).network.aligned == 2);
  constexpr double end = 2147482800.0 + 240 + 20 * 60 + 100; // 03:00 of that day, and what follows
  for (const auto& proxy : report.proxies) {
    const auto time = std::stod(proxy.values.at(0).second);
    CHECK(time > end - 40);
    CHECK(time < end);
  }
  const auto lines = lines_of(file);
  REQUIRE(lines.size() > 80);
  double last = 2147482800.0 + 240;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const auto time = std::stod(lines[i]);
    CHECK(time > last);
    CHECK(time < last + 200);
    last = time;
  }
  CHECK(last > 2147483648.0);
}

TEST_CASE("a reader's pause between two of its lives is told by the world's clock",
          "[ecology][STR-07]") {
  const auto what = describe(
      "[ecology]\nname = \"reborn\"\nduration = \"10min\"\n[mote_type.probe]\ntype = 100\n"
      "transducers.temperature = { model = \"constant\", value = 20 }\n"
      "[[island]]\nid = 1\nname = \"hall\"\nmote = [\n"
      "{ id = 2, type = \"probe\", position_m = [5, 0], apps = [{ app = \"stream_writer\", "
      "transducer = \"temperature\", stream = 1, every = \"2s\", to = \"hall/probe-3\" }] },\n"
      "{ id = 3, type = \"probe\", position_m = [0, 5], apps = [{ app = \"stream_reader\", "
      "stream = 1, every = \"2s\" }] }]\n"
      "[[fault]]\nat = \"5min\"\nkind = \"crash\"\nmote = \"hall/probe-3\"\nfor = \"5s\"\n");
  for (std::uint64_t seed = 1; seed <= seeds(5); ++seed) {
    CAPTURE(seed);
    const auto report = run(what, seed);
    REQUIRE(report.streams.size() == 1);
    CHECK(report.streams.at(0).pause >= 5s); // each life begins with another time on its clock
    CHECK(report.streams.at(0).pause < 2min);
  }
}
