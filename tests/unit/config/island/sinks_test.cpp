// What a file may say about further sinks of an island.
#include <string>

#include "support/catch.hpp"
#include "unit/config/sample.hpp"

using namespace rubicon;
using namespace rubicon::config;
using namespace rubicon::test;

TEST_CASE("a mote with a backbone is a further sink", "[config][network]") {
  CHECK_FALSE(good(mote_head).islands.at(0).motes.at(0).backbone);
  const auto usual = good(mote_head + "backbone = {}\n").islands.at(0).motes.at(0).backbone;
  REQUIRE(usual);
  CHECK(usual->baud == 57600);
  CHECK(usual->latency == 2ms);
  CHECK(usual->jitter == 1ms);
  const auto own = good(mote_head + "backbone = { baud = 115200, latency = '20ms', jitter = '0s', "
                                    "queue = 8 }\n")
                       .islands.at(0)
                       .motes.at(0)
                       .backbone;
  REQUIRE(own);
  CHECK(own->baud == 115200);
  CHECK(own->latency == 20ms);
  CHECK(own->jitter == 0s);
  CHECK(own->queue == 8);
}

TEST_CASE("motes may be within reach of a further sink alone", "[config][network]") {
  const std::string far = "[[island.mote]]\nid = 3\ntype = \"c\"\nposition_m = [500, 0]\n";
  const std::string farther = "[[island.mote]]\nid = 4\ntype = \"c\"\nposition_m = [510, 0]\n";
  CHECK(good(mote_head + far + "backbone = {}\n" + farther).islands.at(0).motes.size() == 3);
}

TEST_CASE("further sinks are checked", "[config][network]") {
  check_mistakes(mote_head, R"(
backbone = { jitter = "1s" }
#                     ^ `jitter` must be a time from 0 ns to 100 ms, not "1s"

path = [["10s", [1, 2]], ["1min", [3, 2]]]
backbone = {}
#          ^ a further sink cannot have a `path`: it is connected to a cable

channel = 20
backbone = {}
#          ^ a further sink has the `channel` of its island

backbone = {}
[[fault]]
at = "1min"
kind = "duplicate_id"
mote = "k/c-2"
#      ^ mote `c-2` is a further sink, which stays at its cable: name another mote
position_m = [2, 2]

backbone = {}
[[fault]]
at = "1min"
kind = "move"
mote = "k/c-2"
#      ^ mote `c-2` is a further sink, which stays at its cable: name another mote
to_island = "k"
to_m = [2, 2]

[[fault]]
at = "1min"
kind = "unplug"
further_sink = "k/c-2"
#              ^ mote `c-2` is no further sink: it has no `backbone`

backbone = {}
[[fault]]
at = "1min"
kind = "unplug"
further_sink = "k/c-2"
island = "k"
#        ^ `island` has no effect with `further_sink`
)");
  check_mistakes(island_head, R"(
duty_cycle = { period = "4s" }
mote = [{ id = 2, type = "c", position_m = [1, 2], backbone = {} }]
#                                                             ^ an island with `duty_cycle` cannot have further sinks

low_power_listening = {}
mote = [{ id = 2, type = "c", position_m = [1, 2], backbone = {} }]
#                                                             ^ an island with `low_power_listening` cannot have further sinks
)");
}
