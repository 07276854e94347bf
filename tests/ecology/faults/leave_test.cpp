// Motes leave, and their gateway says why (IF-13, DIS-06).
#include <algorithm>
#include <string>

#include <spdlog/spdlog.h>

#include "ecology/ecology_files.hpp"
#include "support/catch.hpp"
#include "support/seeds.hpp"

using namespace rubicon;
using namespace rubicon::test;

TEST_CASE("each mote that leaves does so once, for its reason", "[ecology][IF-13][DIS-06]") {
  spdlog::set_level(spdlog::level::off);
  const auto what = describe(R"(
[ecology]
name = "leaving"
duration = "5min"
[radio.propagation]
model = "log_distance"
exponent = 3
[mote_type.badge]
type = 1
transducers.light = { model = "constant", value = 5 }
apps = [{ app = "sampler", transducers = ["light"], every = "1s" }]
[[island]]
id = 1
name = "hall"
sink.position_m = [0, 0]
[[island.mote]]
id = 2
name = "stays"
type = "badge"
position_m = [5, 0]
[[island.mote]]
id = 3
name = "walks-off"
type = "badge"
path = [["0s", [0, 5]], ["1min", [0, 5]], ["4min", [0, 185]]]
[[island.mote]]
id = 4
name = "runs-down"
type = "badge"
position_m = [0, 6]
battery = "0.8mAh"
[[island.mote]]
id = 5
name = "ends"
type = "badge"
position_m = [5, 5]
[[island.mote]]
id = 6
name = "vanishes"
type = "badge"
path = [["0s", [-5, 0]], ["100s", [-5, 0]], ["101s", [-900, 0]]]
[[fault]]
at = "90s"
kind = "battery_end"
mote = "hall/ends"
)");
  const auto cause_of = [](const report::run_report& x, const std::string& name) {
    const auto& motes = x.islands.at(0).motes;
    return std::ranges::find(motes, name, &report::mote_report::name)->left_cause;
  };
  for (std::uint64_t seed = 1; seed <= seeds(5); ++seed) {
    CAPTURE(seed);
    const auto x = run(what, seed);
    CHECK(cause_of(x, "stays").empty());
    CHECK(cause_of(x, "walks-off") == "out_of_range");
    CHECK(cause_of(x, "runs-down") == "battery");
    CHECK(cause_of(x, "ends") == "battery");
    CHECK(cause_of(x, "vanishes") == "silence");
    const auto left = std::ranges::count_if(
        x.event_log, [](const auto& line) { return line.what.starts_with("left: "); });
    CHECK(left == 4);
  }
}
