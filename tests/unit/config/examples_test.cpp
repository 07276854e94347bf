#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>

#include "config/load.hpp"
#include "core/numbers/math.hpp"
#include "support/catch.hpp"
#include "unit/config/sample.hpp"

using namespace rubicon;
using namespace rubicon::config;

namespace {

ecology_description example(const std::string& name) {
  auto x = load_file(RUBICON_SOURCE_DIR "/config/" + name);
  for (const auto& each : x.problems)
    UNSCOPED_INFO(to_string(each));
  REQUIRE(x.problems.empty());
  return *std::move(x.ecology);
}

/// The ```toml examples of the configuration reference.
std::vector<std::string> documented_examples() {
  std::ifstream file(RUBICON_SOURCE_DIR "/docs/configuration.md");
  std::vector<std::string> all;
  bool inside = false;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("```")) {
      inside = line == "```toml";
      if (inside)
        all.emplace_back();
    } else if (inside) {
      all.back() += line + '\n';
    }
  }
  return all;
}

} // namespace

TEST_CASE("the home example is a flat with two islands, a robot and proxies", "[config][GEN-04]") {
  const auto x = example("home.toml");
  CHECK(x.name == "home");
  CHECK(x.seed == 1);
  CHECK(x.length == 12min);
  REQUIRE(x.islands.size() == 2);
  for (const auto& island : x.islands)
    CHECK(island.motes.size() >= 6);
  CHECK(std::any_of(x.peers.begin(), x.peers.end(),
                    [](const auto& peer) { return peer.name == "robot" && peer.id.value == 30; }));
  REQUIRE(x.faults.size() == 2);
  CHECK(std::get<kill_fault>(x.faults[0].what).peer == peer_id{1});
  CHECK(x.faults[0].at == 5min);
  const auto& fault = std::get<battery_end_fault>(x.faults[1].what);
  CHECK(fault.mote == mote_address{island_id{2}, mote_id{3}});
  CHECK(x.faults[1].at == 8min);
}

TEST_CASE("every type of mote in an example has its proxy class", "[config][PXY-13]") {
  for (const auto* file : {"home.toml", "intel-lab.toml"}) {
    const auto x = example(file);
    for (const auto& island : x.islands) {
      for (const auto& mote : island.motes) {
        CAPTURE(file, mote.name);
        CHECK(std::any_of(x.proxies.begin(), x.proxies.end(), [&mote](const auto& proxy) {
          return std::any_of(proxy.types.begin(), proxy.types.end(), [&mote](const auto& types) {
            return types.first <= mote.type && mote.type <= types.last;
          });
        }));
      }
    }
  }
}

TEST_CASE("the Intel lab example has 54 motes at the lab's positions", "[config][GEN-04]") {
  const auto x = example("intel-lab.toml");
  CHECK(x.length == 24h);
  REQUIRE(x.islands.size() == 1);
  const auto& lab = x.islands.front();
  REQUIRE(lab.motes.size() == 54);
  CHECK(lab.motes.front().place == position{21.5, 23, 0});
  CHECK(lab.motes.back().place == position{26.5, 2, 0});
  CHECK(lab.motes[49].name == "mica2dot-50");
  CHECK(lab.motes[49].place == position{38.5, 1, 0});
  double sum = 0;
  for (std::size_t i = 0; i < lab.motes.size(); ++i) {
    CHECK(lab.motes[i].id.value == i + 1);
    const auto& app = std::get<sampler_app>(lab.motes[i].apps.at(0));
    CHECK(app.every == 31s);
    CHECK(app.transducers.size() == 4);
    sum += lab.motes[i].place.x_m + 100 * lab.motes[i].place.y_m;
  }
  CHECK(sum == Approx(94205.5)); // of the x and 100 times the y column of mote_locs.txt
}

TEST_CASE("what the configuration reference shows can be written", "[config][docs]") {
  const auto all = documented_examples();
  REQUIRE(all.size() >= 6);
  for (const auto& text : all) {
    CAPTURE(text);
    const auto found = load_text(text, "t").problems;
    for (const auto& each : found) {
      // An excerpt lacks what it refers to and what it is a part of; what it has must be right.
      const bool excerpt = each.message.find("lacks the table") != std::string::npos ||
                           each.message.find("is named") != std::string::npos ||
                           each.message.find("no component starts") == 0 ||
                           each.message.find("neither an") != std::string::npos ||
                           each.message.find("`type` is missing") == 0 ||
                           each.message.find("cannot be opened") != std::string::npos ||
                           each.message.find("unknown key `transducers` in the file") == 0 ||
                           each.message.find("unknown key `actuators` in the file") == 0;
      CAPTURE(to_string(each));
      CHECK(excerpt);
    }
  }
}
