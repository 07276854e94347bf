// Quantities of a file's own, dead bands of samplers, and times of day.
#include <string>

#include "support/catch.hpp"
#include "unit/config/sample.hpp"

using namespace rubicon;
using namespace rubicon::config;
using namespace rubicon::test;

namespace {

const std::string co2 = "[[quantity]]\nname = \"co2\"\nunit = \"ppm\"\n";

/// A file with a mote that measures `co2`, and what follows it.
std::string air_file(const std::string& rest) {
  return "[ecology]\nname = \"t\"\n" + co2 +
         "[[island]]\nname = \"k\"\nid = 1\n[[island.mote]]\nid = 2\ntype = 7\n"
         "position_m = [1, 2]\n"
         "transducers.co2 = { model = \"constant\", value = 600, resolution = 2 }\n"
         "transducers.temperature = { model = \"constant\", value = 20 }\n" +
         rest;
}

const sampler_app& sampler_of(const ecology_description& x) {
  return std::get<sampler_app>(x.islands.at(0).motes.at(0).apps.at(0));
}

const proxy::rule& rule_of(const ecology_description& x) {
  return std::get<proxy::rules_config>(x.peers.at(0).apps.at(0)).rules.at(0);
}

std::string rule_file(const std::string& start, const std::string& rule) {
  return "[ecology]\nname = \"t\"\n" + start +
         "[[peer]]\nname = \"pc\"\nid = 300\n[[peer.apps]]\napp = \"rules\"\n"
         "[[peer.apps.rules]]\n" +
         rule;
}

} // namespace

TEST_CASE("a file adds quantities with units, which motes measure as the usual ones", "[config]") {
  const auto x = good(air_file(
      "apps = [{ app = \"sampler\", transducers = [\"temperature\", \"co2\"] }]\n"
      "[[proxy]]\nname = \"p\"\ntypes = [7]\n[[proxy.field]]\nname = \"co2\"\nchannel = 1\n"
      "transducer = \"co2\"\n"));
  const auto own = static_cast<device::quantity>(device::first_own_quantity);
  const auto& mote = x.islands.at(0).motes.at(0);
  REQUIRE(mote.transducers.size() == 2);
  CHECK(mote.transducers[0].kind == device::quantity::temperature);
  CHECK(mote.transducers[1].kind == own);
  CHECK(mote.transducers[1].resolution == 2);
  CHECK(sampler_of(x).transducers == std::vector{device::quantity::temperature, own});
  const auto& field = x.proxies.at(0).fields.at(0);
  CHECK(field.unit == "ppm");
  CHECK(field.offset == 2);
  CHECK(field.scale == 2);
}

TEST_CASE("a quantity has a name of its own", "[config][GEN-06]") {
  check_mistakes(head, R"(
[[quantity]]
name = "co2"
unit = "ppm"
[[quantity]]
name = "CO2"
#      ^ quantity `CO2` is already taken (line 7, column 8)
[[quantity]]
#< `name` is missing in [[quantity]]
unit = "ppm"

[[quantity]]
name = "light pink"
#      ^ `name` must be a name of 1 to 32 letters, digits, - and _, not "light pink"
unit = ""
#      ^ `unit` must be a text of 1 to 16 octets without control characters, not ""
)");
  std::string many = std::string(head);
  for (std::size_t i = 0; i <= device::quantities_max - device::first_own_quantity; ++i)
    many += "[[quantity]]\nname = \"q" + std::to_string(i) + "\"\n";
  CHECK(problem_in(many).find("a file has at most 23 quantities of its own") != std::string::npos);
  CHECK(problem_in(std::string(head) + "[[quantity]]\nname = \"Light\"\n")
            .find("quantity `Light` is already taken") != std::string::npos);
}

TEST_CASE("a quantity that the file does not add is unknown", "[config][GEN-06]") {
  check_mistakes(mote_head, R"(
transducers.co2 = { model = "constant", value = 600 }
#           ^ unknown key `co2` in transducers: there is temperature, humidity, light, voltage,
#   presence, acceleration, magnetism, sound

apps = [{ app = "sampler", transducers = ["co2"] }]
#                                         ^ `transducers` must be "temperature", "humidity",
#   "light", "voltage", "presence", "acceleration", "magnetism", "sound" or "signal", not "co2"
)");
}

TEST_CASE("a dead band is in the units of what is measured", "[config]") {
  const auto x = good(air_file("[[island.mote.apps]]\napp = \"sampler\"\n"
                               "transducers = [\"temperature\", \"co2\", \"signal\"]\n"
                               "every = \"10s\"\ndead_band = { co2 = 51, temperature = 0 }\n"));
  CHECK(sampler_of(x).dead_band == std::vector<std::int32_t>{1, 26, 0});
  CHECK(sampler_of(x).silence_max == 100s);
  const auto y = good(air_file("[[island.mote.apps]]\napp = \"sampler\"\n"
                               "transducers = [\"signal\"]\ndead_band.signal = 3\n"
                               "silence_max = \"1h\"\n"));
  CHECK(sampler_of(y).dead_band == std::vector<std::int32_t>{3});
  CHECK(sampler_of(y).silence_max == 1h);
}

TEST_CASE("a sampler without a dead band is as it was", "[config]") {
  const auto x = good(air_file("apps = [{ app = \"sampler\", transducers = [\"co2\"] }]\n"));
  CHECK(sampler_of(x).dead_band.empty());
  CHECK(sampler_of(x).silence_max == 0s);
}

TEST_CASE("a dead band is of what is sent, and ends in time", "[config][GEN-06]") {
  check_mistakes(mote_head, R"(
[[island.mote.apps]]
app = "sampler"
transducers = ["temperature"]
dead_band = { light = 3 }
#             ^ `light` is not among the `transducers`

[[island.mote.apps]]
app = "sampler"
transducers = ["temperature"]
dead_band = { temperature = -1 }
#                           ^ `temperature` must be a number from 0, not -1

[[island.mote.apps]]
app = "sampler"
transducers = ["temperature"]
dead_band = 0.5
#           ^ `dead_band` must be a table by quantity, as in { temperature = 0.5 }, not 0.5

[[island.mote.apps]]
app = "sampler"
transducers = ["temperature"]
silence_max = "1h"
#             ^ `silence_max` has no effect without a `dead_band`

[[island.mote.apps]]
app = "sampler"
transducers = ["temperature"]
every = "10s"
dead_band = { temperature = 1 }
silence_max = "9s"
#             ^ `silence_max` must not be shorter than `every`, which is 10 s
)");
}

TEST_CASE("a rule has a time of day, in the time of the ecology", "[config]") {
  const std::string rule = "at = \"07:30\"\nwrite = \"a\"\nthen = \"on\"\n";
  const auto plain = good(rule_file("", rule));
  CHECK(rule_of(plain).daily == 7h + 30min);
  CHECK(rule_of(plain).when.empty());
  CHECK(rule_of(good(rule_file("start = \"06:00:30\"\n", rule))).daily == 89min + 30s);
  CHECK(rule_of(good(rule_file("start = \"22:00\"\n", rule))).daily == 9h + 30min);
  const auto x =
      good(rule_file("", "at = \"00:00:00\"\nwhen = \"b\"\nequals = [\"x\"]\nwrite = "
                         "\"a\"\nfrom = \"c.d\"\notherwise = \"off\"\nafter = \"2s\"\n"));
  CHECK(rule_of(x).daily == 0s);
  CHECK(rule_of(x).when == "b");
  CHECK(rule_of(x).after == 2s);
  CHECK(rule_of(x).writes.at(0).from == "c.d");
}

TEST_CASE("a day in wall time may begin now", "[config]") {
  const std::string rule = "at = \"07:30\"\nwrite = \"a\"\nthen = \"on\"\n";
  overrides instead;
  instead.time_of_day = 6h;
  const auto virtual_run = load_text(rule_file("start = \"now\"\n", rule), "t", instead);
  REQUIRE(virtual_run.problems.size() == 1);
  CHECK(virtual_run.problems[0].message == "`start` = \"now\" needs mode = \"wall\": a run in "
                                           "virtual time does not depend on when it is run");
  instead.mode = run_mode::wall;
  const auto wall = load_text(rule_file("start = \"now\"\n", rule), "t", instead);
  REQUIRE(wall.ecology);
  CHECK(wall.ecology->day_begins == 6h);
  CHECK(rule_of(*wall.ecology).daily == 90min);
  const auto said = load_text(rule_file("start = \"05:00\"\n", rule), "t", instead);
  REQUIRE(said.ecology);
  CHECK(said.ecology->day_begins == 5h);
}

TEST_CASE("what a rule says of times and of other tuples fits together", "[config][GEN-06]") {
  check_mistakes(std::string(head) + "[[peer.apps]]\napp = \"rules\"\n", R"(
[[peer.apps.rules]]
at = "24:00"
#    ^ `at` must be a time of day in quotation marks, as in "07:30" or "07:30:15", not "24:00"
write = "a"
then = "on"

[[peer.apps.rules]]
at = 07:30:00
#    ^ `at` must be a time of day in quotation marks, as in "07:30" or "07:30:15", not a date or time
write = "a"
then = "on"

[[peer.apps.rules]]
at = "07:30"
above = 3
#       ^ `above` has no effect without `when`
otherwise = "off"
#           ^ `otherwise` has no effect without `when`
write = "a"
then = "on"

[[peer.apps.rules]]
at = "07:30"
when = "b"
equals = ["x"]
lasting = "1s"
#         ^ `lasting` has no effect with `at`
write = "a"
from = "c"
then = "on"
#      ^ `then` has no effect with `from`

[[peer.apps.rules]]
when = "b"
above = 1
point = "a"
#       ^ `point` has no effect with `from`
from = "c"

[[peer.apps.rules]]
#< a rule needs either `above`, `below` or both, or `equals`
at = "07:30"
when = "b"
write = "a"
then = "on"
)");
  CHECK(problem_in("[ecology]\nname = \"t\"\nstart = \"7:30\"\n[[peer]]\nname = \"p\"\nid = 1\n")
            .find("`start` must be a time of day") != std::string::npos);
}
