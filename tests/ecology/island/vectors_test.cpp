// Synaptic vectors of several packets, both ways over several hops, on an air that loses nothing:
// none is missed where the file is accepted (SYN-10, SYN-16).
#include <sstream>
#include <string>

#include "ecology/ecology_files.hpp"
#include "support/catch.hpp"
#include "support/seeds.hpp"

using namespace rubicon;
using namespace rubicon::test;

namespace {

/// A line whose first and last mote send each other vectors.
config::ecology_description line(int hops, int size, std::string_view tick) {
  std::ostringstream toml;
  toml << "[ecology]\nname = 'line'\nduration = '4min'\ntick = '" << tick << "'\n"
       << "[radio]\nrange = '25m'\n[mote_type.unit]\ntype = 1\n"
       << "[[island]]\nname = 'a'\nid = 1\ncrystal_ppm = 40\nkeep_alive = '30s'\n"
       << "sink.position_m = [0, 0]\n";
  for (int i = 0; i <= hops; ++i) {
    toml << "[[island.mote]]\nid = " << 2 + i << "\nname = 'n" << i
         << "'\ntype = 'unit'\nposition_m = [" << 20 + 20 * i << ", 0]\n";
    if (i == 0 || i == hops)
      toml << "apps = [{ app = 'reservoir', units = 16, from = [{ node = 'a/n" << hops - i
           << "', size = " << size << " }], to = [{ node = 'a/n" << hops - i << "', size = " << size
           << " }] }]\n";
  }
  toml << "[[expect]]\nkind = 'vectors'\nmissed = 0\nfrom = '60s'\n";
  return describe(toml.str());
}

/// None may be missed from the second minute on.
void check_line(int hops, int size, std::string_view tick, std::uint64_t seed) {
  CAPTURE(hops, size, tick, seed);
  const auto done = run(line(hops, size, tick), seed);
  CHECK(done.violations.empty());
  CHECK(done.motes_joined() == static_cast<std::uint64_t>(hops) + 1);
  REQUIRE(done.expectations.size() == 1);
  CHECK(done.expectations[0].outcome == report::expectation_report::verdict::met);
}

} // namespace

TEST_CASE("vectors of several packets cross each other over several hops, none is missed",
          "[ecology][SYN-10][SYN-16]") {
  const std::string tick = GENERATE("500ms", "2s");
  const int hops = GENERATE(1, 3, 8);
  const int size = GENERATE(25, 64);
  for (std::uint64_t seed = 1; seed <= seeds(2); ++seed)
    check_line(hops, size, tick, seed);
}

/// On demand: `test_ecology "[matrix]"`.
TEST_CASE("vectors of 25 to 64 elements over 1 to 8 hops, of 20 seeds each, none is missed",
          "[.][matrix]") {
  for (const auto* tick : {"500ms", "2s"})
    for (int hops = 1; hops <= 8; ++hops)
      for (const int size : {25, 26, 40, 51, 64})
        for (std::uint64_t seed = 1; seed <= 20; ++seed)
          check_line(hops, size, tick, seed);
}

TEST_CASE("the vectors of sixteen motes in one place never collide", "[ecology][SYN-16]") {
  const int size = GENERATE(6, 25);
  std::ostringstream toml;
  toml << "[ecology]\nname = 'ring'\ntick = '500ms'\n[radio]\nrange = '25m'\n"
       << "[mote_type.unit]\ntype = 1\n[[island]]\nname = 'a'\nid = 1\ncrystal_ppm = 40\n"
       << "keep_alive = '3min'\nsink.position_m = [0, 0]\n";
  for (int i = 0; i < 16; ++i)
    toml << "[[island.mote]]\nid = " << 2 + i << "\nname = 'n" << i
         << "'\ntype = 'unit'\nposition_m = [" << 1 + i % 4 << ", " << 1 + i / 4 << "]\n"
         << "apps = [{ app = 'reservoir', units = 6, from = [{ node = 'a/n" << (i + 15) % 16
         << "', size = " << size << " }], to = [{ node = 'a/n" << (i + 1) % 16
         << "', size = " << size << " }] }]\n";
  auto ring = describe(toml.str());
  const auto after = [&](duration length) {
    ring.length = length;
    const auto report = run(ring);
    CHECK(report.violations.empty());
    CHECK(report.motes_joined() == 16);
    return report;
  };
  const auto first = after(5min).radio();
  const auto all = after(10min).radio();
  // 9 600 vectors to all of 16 others; what is left is of frames without slots that meet.
  CHECK(all.lost.at("collision") - first.lost.at("collision") < 200);
  CHECK(all.mac_failed.at("channel_access_failure") -
            first.mac_failed.at("channel_access_failure") <=
        2);
}
