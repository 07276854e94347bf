// Labels: what people call things, beside their names.
#include <string>

#include "config/listing.hpp"
#include "config/load.hpp"
#include "config/plan/labels.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::config;

namespace {

using kind = label_table::kind;

std::string file_with(const std::string& label) {
  return R"([ecology]
name = "flat"
duration = "1min"

[[island]]
id = 1
name = "kitchen"
label = "Küche"

[[island.mote]]
id = 2
name = "window"
label = )" +
         label + R"(
type = 101
position_m = [1, 0]
transducers.temperature = { model = "constant", value = 20 }
apps = [{ app = "sampler", transducers = ["temperature"], every = "10s" }]

[[peer]]
id = 40
name = "pc"
count = 2
label = "PC im Flur"
apps = [{ app = "proxy_manager" }]

[[proxy]]
name = "climate"
label = "Klima"
types = [101]
field = [{ name = "temperature", encoding = "i16", channel = 1 }]
)";
}

} // namespace

TEST_CASE("islands, motes, peers and proxies have labels beside their names", "[config]") {
  auto text = file_with(R"("Küche / Fenster links \U0001F600")");
  text.erase(text.find("count = 2\n"), 10);
  const auto found = load_text(text, "a.toml");
  for (const auto& each : found.problems)
    FAIL_CHECK(to_string(each));
  REQUIRE(found.ecology);
  const auto& labels = found.ecology->labels;
  CHECK(labels.of(kind::island, "kitchen") == "Küche");
  CHECK(labels.of(kind::mote, "kitchen/window") == "Küche / Fenster links 😀");
  CHECK(labels.of(kind::peer, "pc") == "PC im Flur");
  CHECK(labels.of(kind::proxy, "climate") == "Klima");
  CHECK(labels.of(kind::peer, "kitchen").empty()); // each kind has names of its own
  CHECK(labels.with_name(kind::island, "kitchen") == "kitchen (Küche)");
  CHECK(labels.with_name(kind::island, "bath") == "bath");
  CHECK(found.ecology->islands[0].motes[0].name == "window"); // keys and paths have the names
}

TEST_CASE("gateways and motes behind a real line have labels too", "[config]") {
  const auto found = load_text(R"([ecology]
name = "flat"
mode = "wall"
[[island]]
id = 1
name = "kitchen"
[island.real]
device = "/dev/ttyUSB0"
first = 5
last = 9
[[island.real.mote]]
id = 7
name = "stove"
label = "Herd"
[[island.plain]]
am_type = 6
type = 9
[island.gateway]
label = "PC am Fenster"
)",
                               "a.toml");
  for (const auto& each : found.problems)
    FAIL_CHECK(to_string(each));
  REQUIRE(found.ecology);
  CHECK(found.ecology->labels.of(kind::mote, "kitchen/stove") == "Herd");
  CHECK(found.ecology->labels.of(kind::peer, "kitchen-gateway") == "PC am Fenster");
  const auto text = listing(*found.ecology);
  CAPTURE(text);
  CHECK(text.find("  kitchen/stove  1/7  real  Herd\n") != std::string::npos);
  CHECK(text.find("  kitchen-gateway  1  gateway of kitchen  PC am Fenster\n") !=
        std::string::npos);
  const auto alias = load_text(R"([ecology]
name = "flat"
[[island]]
id = 1
name = "kitchen"
[[island.mote]]
id = 2
type = 101
position_m = [1, 0]
[[island.alias]]
id = 2
label = "PC im Flur"
)",
                               "a.toml");
  for (const auto& each : alias.problems)
    FAIL_CHECK(to_string(each));
  REQUIRE(alias.ecology);
  CHECK(alias.ecology->labels.of(kind::peer, "kitchen-gateway-2") == "PC im Flur");
}

TEST_CASE("a label is bounded, and does nothing to a terminal", "[config][GEN-06]") {
  const auto label = GENERATE(as<std::string>{}, R"("")", R"("a\nb")", R"("\u001b[2J")",
                              R"("\u202Eabc")", "7", '"' + std::string(101, 'x') + '"');
  CAPTURE(label);
  const auto found = load_text(file_with(label), "a.toml");
  REQUIRE(!found.problems.empty());
  const auto problem = to_string(found.problems.front());
  CAPTURE(problem);
  CHECK(problem.find("`label` must be a text of 1 to 100 octets of UTF-8 without control "
                     "characters") != std::string::npos);
  CHECK(found.problems.front().line == 13);
}

TEST_CASE("a file without labels has none", "[config]") {
  const auto found =
      load_text("[ecology]\nname = \"x\"\n[[peer]]\nid = 1\nname = \"pc\"\n", "a.toml");
  REQUIRE(found.ecology);
  CHECK(found.ecology->labels.empty());
}
