// Several sinks in one island.
#include <algorithm>
#include <string>

#include "ecology/ecology_files.hpp"
#include "support/catch.hpp"
#include "support/seeds.hpp"

using namespace rubicon;
using namespace rubicon::test;

namespace {

constexpr const char* probe = R"(
[radio]
range = "24m"
loss = 0.05
[mote_type.probe]
type = 100
transducers.temperature = { model = "constant", value = 20 }
apps = [{ app = "sampler", transducers = ["temperature"], every = "10s", reliable = true }]
[[island]]
id = 1
name = "hall"
)";

/// The sink at one end, eight motes, the last of which may be a further sink.
std::string line(bool has_further, const std::string& more = {}) {
  auto toml = "[ecology]\nname = \"line\"\nduration = \"15min\"\n" + std::string(probe);
  for (int i = 1; i <= 8; ++i) {
    const bool is_sink = has_further && i == 8;
    toml += "[[island.mote]]\nid = " + std::to_string(i + 1) +
            "\ntype = \"probe\"\nposition_m = [" + std::to_string(20 * i) + ", 0]\n" +
            (is_sink ? "backbone = {}\n" : "");
  }
  return toml + more;
}

/// Over the radio.
double mean_hops(const report::run_report& x) {
  const auto& motes = x.islands.at(0).motes;
  double sum = 0;
  double count = 0;
  for (const auto& mote : motes) {
    if (mote.further_sink)
      continue;
    ++count;
    auto at = mote.address.mote;
    for (int i = 0; i < 16 && at != default_sink; ++i) {
      const auto here = std::ranges::find(
          motes, at, [](const report::mote_report& each) { return each.address.mote; });
      if (here == motes.end() || here->further_sink)
        break;
      ++sum;
      at = here->parent;
    }
  }
  return sum / count;
}

} // namespace

TEST_CASE("a further sink at the end of a line halves the hops, and no reading is lost",
          "[ecology][network]") {
  const auto alone = describe(line(false));
  const auto both = describe(line(true));
  for (std::uint64_t seed = 1; seed <= seeds(20); ++seed) {
    CAPTURE(seed);
    const auto before = run(alone, seed);
    const auto report = run(both, seed);
    CHECK(report.violations.empty());
    CHECK(report.motes_left() == 0);
    CHECK(mean_hops(report) < 0.65 * mean_hops(before));
    CHECK(report.islands.at(0).network.backbone.up > 100);
    CHECK(report.islands.at(0).network.backbone.down > 20);
    for (const auto& mote : report.islands.at(0).motes) {
      CHECK(mote.joined);
      CHECK(mote.messages.reliable_failed == 0);
    }
  }
}

TEST_CASE("motes are back within two minutes after their further sink has crashed",
          "[ecology][network]") {
  const auto what =
      describe(line(true, "[[fault]]\nat = \"5min\"\nkind = \"crash\"\nmote = \"hall/probe-9\"\n"
                          "for = \"5min\"\n"));
  for (std::uint64_t seed = 1; seed <= seeds(20); ++seed) {
    CAPTURE(seed);
    const auto report = run(what, seed);
    CHECK(report.violations.empty());
    CHECK(report.motes_left() == 0);
    for (const auto& mote : report.islands.at(0).motes)
      if (!mote.further_sink)
        CHECK(mote.silence < 2min);
  }
}

TEST_CASE("a further sink whose backbone is cut sends by radio", "[ecology][network]") {
  const auto what = describe(
      line(true, "[[fault]]\nat = \"5min\"\nkind = \"unplug\"\nfurther_sink = \"hall/probe-9\"\n"
                 "for = \"5min\"\n"));
  const auto report = run(what, 1);
  CHECK(report.violations.empty());
  CHECK(report.motes_left() == 0);
  CHECK(report.islands.at(0).network.backbone.lost.at("cut") > 0);
  for (const auto& mote : report.islands.at(0).motes)
    CHECK(mote.silence < 2min);
}

TEST_CASE("a grid has a sink in each corner", "[ecology][network]") {
  std::string toml = "[ecology]\nname = \"grid\"\nduration = \"15min\"\n" + std::string(probe);
  for (int i = 1; i < 25; ++i) {
    const bool is_corner = i == 4 || i == 20 || i == 24;
    toml += "[[island.mote]]\nid = " + std::to_string(i + 1) +
            "\ntype = \"probe\"\nposition_m = [" + std::to_string(20 * (i % 5)) + ", " +
            std::to_string(20 * (i / 5)) + "]\n" + (is_corner ? "backbone = {}\n" : "");
  }
  const auto what = describe(toml);
  for (std::uint64_t seed = 1; seed <= seeds(3); ++seed) {
    CAPTURE(seed);
    const auto report = run(what, seed);
    CHECK(report.violations.empty());
    CHECK(report.motes_left() == 0);
    CHECK(mean_hops(report) < 3);
  }
}
