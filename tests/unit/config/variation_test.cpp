#include <cstdint>
#include <string>

#include "config/load.hpp"
#include "config/run/fault_variation.hpp"
#include "config/run/variation.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::config;

namespace {

const std::string file = R"([ecology]
name = "e"
duration = "1min"
[parameters]
period = 10
loss = { from = 0.1, to = 0.5 }
outage = { from = "10s", to = "60s" }
retries = { from = 0, to = 7 }
[radio]
loss = "${loss}"
retries = "${retries}"
[[island]]
id = 1
name = "room"
keep_alive = "${period}s"
[[island.mote]]
id = 2
name = "meter"
type = 101
position_m = [5, 0]
[[fault]]
at = "20s"
kind = "crash"
mote = "room/meter"
for = "${outage}"
[[fault]]
at = "30s"
kind = "unplug"
island = "room"
for = "5s"
)";

const settings varies{"ecology.vary_faults=true"};

} // namespace

TEST_CASE("what a seed draws is what its run has", "[config][ACT-04]") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    overrides instead;
    instead.seed = seed;
    instead.settings = varies;
    const auto found = load_text(file, "e.toml", instead);
    REQUIRE(found.problems.empty());
    const auto x = variation_of(file, varies, seed);
    REQUIRE(x.drawn.size() == 3);
    CHECK(found.ecology->radio.loss == Approx(std::stod(x.drawn.at("loss"))));
    CHECK(x.drawn.at("outage").ends_with("s"));
    CHECK(std::stoi(x.drawn.at("retries")) <= 7);
    CHECK(x.left_out.size() + found.ecology->faults.size() == 2);
    for (const auto& kind : x.left_out)
      CHECK(leaves_out(seed, kind));
    // Settings with these values make the same of the file.
    overrides given = instead;
    for (const auto& [name, value] : x.drawn)
      given.settings.push_back(name + '=' + value);
    const auto again = load_text(file, "e.toml", given);
    REQUIRE(again.problems.empty());
    CHECK(again.ecology->radio.loss == found.ecology->radio.loss);
    CHECK(variation_of(file, given.settings, seed).drawn.empty());
  }
}

TEST_CASE("what a seed decides is one line of text", "[config][ACT-04]") {
  CHECK(to_text(variation()).empty());
  CHECK(to_text(variation{{{"outage", "12.3s"}, {"loss", "0.2"}}, {"crash", "unplug"}}) ==
        "loss=0.2, outage=12.3s, without crash, without unplug");
}

TEST_CASE("of a file that varies nothing a seed decides nothing", "[config][ACT-04]") {
  for (const auto* toml : {"", "x", "[ecology]\nseed = 3\n", "[parameters]\nloss = 0.1\n",
                           "[parameters]\nloss = { from = 1 }\n", "[parameters", "parameters = 3"})
    CHECK(variation_of(toml, {}, 7).empty());
  CHECK(variation_of("[ecology]\n", varies, 7).empty()); // it has no faults
  CHECK(variation_of(file, {}, 7).left_out.empty());
  CHECK(variation_of(file, {"nothing=3"}, 7).empty()); // which is a mistake
}
