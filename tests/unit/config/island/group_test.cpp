#include <cmath>
#include <set>
#include <string>

#include "core/numbers/math.hpp"
#include "support/catch.hpp"
#include "unit/config/sample.hpp"

using namespace rubicon;
using namespace rubicon::config;
using namespace rubicon::test;

namespace {

/// An island `k` of the medium access only, from line 7 on.
const std::string mac_head = "[ecology]\nname = \"t\"\n[[island]]\nname = \"k\"\nid = 1\n"
                             "stack = \"mac\"\n";

island_description island_after(const std::string& start, const std::string& rest) {
  return good(start + rest).islands.at(0);
}

std::vector<mote_description> group(const std::string& rest) {
  return island_after(mac_head, "[[island.group]]\n" + rest).motes;
}

double distance(const position& a, const position& b) {
  return math::length(a.x_m - b.x_m, a.y_m - b.y_m, a.z_m - b.z_m);
}

} // namespace

TEST_CASE("an island may have the medium access only", "[config]") {
  const auto x = good(mac_head + "sink = { power = \"-10dBm\", promiscuous = true, platform = "
                                 "\"telosb\", apps = [{ app = \"receiver\" }] }\n"
                                 "mote = [{ id = 2, position_m = [900, 0], power = \"-3dBm\" }]\n"
                                 "[[peer]]\nname = \"pc\"\nid = 1\n"
                                 "apps = [{ app = \"proxy_manager\" }]\n");
  const auto& island = x.islands.at(0);
  CHECK(island.stack == stack::mac);
  CHECK(island.gateway_name.empty());
  CHECK(island.sink.transmit_dbm == -10.0);
  CHECK(island.sink.promiscuous);
  REQUIRE(island.sink.apps.size() == 1);
  CHECK(std::holds_alternative<traffic::receiver_config>(island.sink.apps[0]));
  CHECK(island.motes.at(0).transmit_dbm == -3.0);
  CHECK(island.motes.at(0).type == 0);
  CHECK(x.peers.at(0).id == peer_id{1}); // the island takes no PEIS id
  CHECK(std::get<proxy_manager_app>(x.peers.at(0).apps.at(0)).islands.empty());
}

TEST_CASE("an island with the medium access only has nothing of the layers above",
          "[config][GEN-06]") {
  check_mistakes(mac_head, R"(
keep_alive = "5s"
#            ^ `keep_alive` has no effect in an island with stack = "mac"

serial.baud = 9600
#< `serial` has no effect in an island with stack = "mac"

[island.gateway]
#< `gateway` has no effect in an island with stack = "mac"
name = "g"

[[island.mote]]
id = 2
position_m = [0, 0]
transducers.light = { model = "constant", value = 1 }
#< a mote of an island with stack = "mac" has no transducers

[[island.mote]]
id = 2
position_m = [0, 0]
actuators = [{ name = "a", kind = "relay" }]
#           ^ a mote of an island with stack = "mac" has no actuators

[[island.mote]]
id = 2
position_m = [0, 0]
apps = [{ app = "listener" }]
#      ^ a mote of an island with stack = "mac" has no other apps than sender, relay, receiver and member

[[peer]]
name = "pc"
id = 3
links = ["inproc://k-gateway"]
#        ^ no peer or gateway is named `k-gateway`: there is pc

[[peer]]
name = "pc"
id = 3
apps = [{ app = "proxy_manager", islands = ["k"] }]
#                                           ^ island `k` has no gateway, since its stack is "mac"

[[fault]]
at = "1s"
kind = "unplug"
island = "k"
#        ^ an island with stack = "mac" has no serial cable

[[island]]
name = "b"
id = 1
#    ^ island id 1 is already taken (line 5, column 6)

[[island]]
name = "b"
id = 2
[[island.mote]]
id = 2
type = 1
position_m = [0, 0]
apps = [{ app = "messenger", to = "k/mote-2", text = "x" }]
#                                 ^ no mote of island `k` is named `mote-2`: there is none
[[island]]
name = "c"
id = 3

mote = [{ id = 2, position_m = [0, 0] }]
[[island]]
name = "b"
id = 2
[[island.mote]]
id = 2
type = 1
position_m = [0, 0]
apps = [{ app = "messenger", to = "k/mote-2", text = "x" }]
#                                 ^ a mote of an island with stack = "mac" or with a base station accepts
#   no messages
)");
}

TEST_CASE("a power is one that the platform has", "[config][GEN-06]") {
  check_mistakes(mote_head, R"(
power = "1dBm"
#       ^ `power` of a micaz must be from -25 to 0 dBm, not 1

power = "-26dBm"
#       ^ `power` of a micaz must be from -25 to 0 dBm, not -26

power = "1dBm"
platform = "iris"

power = "0dBm"

power = -3
#       ^ `power` must be a power from -100 to 30 dBm with its unit, as in "-98dBm", not -3
)");
  check_mistakes(island_head, R"(
sink.power = "1dBm"
#            ^ `power` of a micaz must be from -25 to 0 dBm, not 1
)");
}

TEST_CASE("no mote is called as references call the sink", "[config][GEN-06]") {
  check_mistakes(mote_head, R"(
name = "sink"
#      ^ `sink` stands for the sink of an island: choose another name

name = "Sink"
#      ^ `Sink` stands for the sink of an island: choose another name

name = "sink2"
)");
}

TEST_CASE("a path begins at the start of the run", "[config]") {
  const auto mote = [](const std::string& rest) {
    return island_after(std::string(island_head), "[[island.mote]]\nid = 2\ntype = 1\n" + rest)
        .motes.at(0);
  };
  const auto x = mote("path = [[\"0s\", [1, 2]], [\"1min\", [3, 4, 5]]]\nstep = \"100ms\"\n");
  CHECK(x.place == position{1, 2, 0});
  REQUIRE(x.path.size() == 2);
  CHECK(x.path[0].at == 0s);
  CHECK(x.path[1].at == 1min);
  CHECK(x.path[1].place == position{3, 4, 5});
  CHECK(x.step == 100ms);
  const auto y = mote("position_m = [7, 8]\npath = [[\"1min\", [3, 4]]]\n");
  REQUIRE(y.path.size() == 2);
  CHECK(y.path[0].place == position{7, 8, 0});
  CHECK(y.step == 1s);
  CHECK(mote("position_m = [7, 8]\n").path.empty());
  check_mistakes(island_head, R"(
[[island.mote]]
id = 2
type = 1
position_m = [1, 2]
path = [["0s", [1, 2]]]
#      ^ `path` begins at 0 s, for which there is `position_m` already

[[island.mote]]
id = 2
type = 1
path = [["1s", [1, 2]]]
#      ^ `path` must begin at "0s", or there must be a `position_m`

[[island.mote]]
id = 2
type = 1
path = [["0s", [1, 2]], ["0s", [1, 2]]]
#                        ^ the times of `path` must increase from one to the next

[[island.mote]]
id = 2
type = 1
path = []
#      ^ `path` must be points of a time and a position, as in [["0s", [0, 2]], ["1min", [30, 2]]],
#   not an empty array

[[island.mote]]
id = 2
type = 1
path = [["0s", 1]]
#              ^ `path` must be [x, y] or [x, y, z] in metres, each at most 1000000, not 1

[[island.mote]]
id = 2
type = 1
position_m = [1, 2]
step = "1s"
#      ^ `step` has no effect without a `path`

[[island.mote]]
id = 2
type = 1
position_m = [1, 2]
path = [["9s", [1, 2]]]
step = "1ms"
#      ^ `step` must be a time from 10 ms to 1 h, not "1ms"
)");
}

TEST_CASE("a group is many motes alike", "[config]") {
  const auto x = island_after(std::string(island_head),
                              "[[island.group]]\ntype = \"c\"\ncount = 3\nfirst = 10\n"
                              "power = \"-5dBm\"\nbattery = \"1Ah\"\nlayout = \"line\"\n"
                              "spacing = \"2m\"\norigin = [1, 1, 1]\ndirection = \"y\"\n"
                              "[[island.group]]\ntype = 9\ncount = 2\nprefix = \"n\"\n"
                              "layout = \"line\"\nspacing = \"1m\"\n")
                     .motes;
  REQUIRE(x.size() == 5);
  CHECK(x[2].id == mote_id{10});
  CHECK(x[2].name == "c-10");
  CHECK(x[2].type_name == "c");
  CHECK(x[2].transmit_dbm == -5.0);
  CHECK(x[2].battery_mah == 1000.0);
  CHECK(x[2].transducers.size() == 1);
  CHECK(x[2].place == position{1, 1, 1});
  CHECK(x[4].place == position{1, 5, 1});
  CHECK(x[0].id == mote_id{2}); // the lowest that are free
  CHECK(x[0].name == "n-2");
  CHECK(x[0].type == 9);
  CHECK(x[1].place == position{1, 0, 0});
}

TEST_CASE("a mote that is added elsewhere does not renumber a group", "[config]") {
  const std::string three = "[[island.group]]\ntype = \"c\"\ncount = 3\nlayout = \"line\"\n"
                            "spacing = \"2m\"\n";
  const auto mote = [](int id) {
    return "[[island.mote]]\ntype = \"c\"\nid = " + std::to_string(id) + "\nposition_m = [1, 1]\n";
  };
  const auto ids = [](const std::string& toml) {
    std::string text;
    for (const auto& x : island_after(std::string(island_head), toml).motes)
      text += (text.empty() ? "" : " ") + to_string(x.id);
    return text;
  };
  CHECK(ids(mote(3) + three) == "3 4 5 6"); // 2 alone is too few
  CHECK(ids(mote(3) + mote(50) + three) == "3 4 5 6 50");
  CHECK(ids(mote(3) + mote(7) + three + three) == "3 4 5 6 7 8 9 10");
}

TEST_CASE("grids, rings and disks", "[config]") {
  const auto grid = group("count = 7\nlayout = \"grid\"\nspacing = \"10m\"\n");
  REQUIRE(grid.size() == 7); // the sink is 1
  CHECK(grid[0].id == mote_id{2});
  CHECK(grid[0].name == "mote-2");
  CHECK(grid[2].place == position{20, 0, 0});
  CHECK(grid[6].place == position{0, 20, 0}); // three columns
  const auto wide =
      group("count = 7\nlayout = \"grid\"\nspacing = \"10m\"\ncolumns = 7\norigin = [5, 5]\n");
  CHECK(wide[6].place == position{65, 5, 0});
  const auto ring = group("count = 4\nlayout = \"ring\"\nradius = \"10m\"\ncentre = [1, 2, 3]\n");
  CHECK(distance(ring[0].place, {11, 2, 3}) < 1e-9);
  CHECK(distance(ring[1].place, {1, 12, 3}) < 1e-9);
  CHECK(distance(ring[3].place, {1, -8, 3}) < 1e-9);
  const auto disk = group("count = 1000\nlayout = \"disk\"\nradius = \"10m\"\ncentre = [5, 5]\n");
  int inner = 0;
  for (const auto& mote : disk) {
    CHECK(distance(mote.place, {5, 5, 0}) <= 10);
    inner += distance(mote.place, {5, 5, 0}) < 5 ? 1 : 0;
  }
  CHECK(inner > 200); // a quarter of the area
  CHECK(inner < 300);
}

TEST_CASE("the random numbers of a disk are those of the seed and the group", "[config][GEN-07]") {
  const std::string disk = "count = 2\nlayout = \"disk\"\nradius = \"10m\"\n";
  const auto toml = mac_head + "[[island.group]]\n" + disk + "[[island.group]]\n" + disk;
  const auto first = good(toml).islands.at(0).motes;
  CHECK(first.at(0).place == good(toml).islands.at(0).motes.at(0).place);
  CHECK_FALSE(first.at(0).place == first.at(1).place);
  CHECK_FALSE(first.at(0).place == first.at(2).place);
  auto seeded = toml;
  seeded.insert(seeded.find("[[island]]"), "seed = 7\n");
  const auto other = good(seeded).islands.at(0).motes;
  CHECK_FALSE(other.at(0).place == first.at(0).place);
  const auto replaced = load_text(toml, "t", {{}, {}, 7});
  REQUIRE(replaced.ecology);
  CHECK(replaced.ecology->islands.at(0).motes.at(0).place == other.at(0).place);
  CHECK(replaced.ecology->seed == 1); // the run has its own say
}

TEST_CASE("a group has ids, names and places to give", "[config][GEN-06]") {
  check_mistakes(mac_head, R"(
[[island.group]]
#< `layout` is missing in [[island.group]]
count = 2

[[island.group]]
#< `count` is missing in [[island.group]]
layout = "grid"
spacing = "1m"

[[island.group]]
count = 0
#       ^ `count` must be a whole number from 1 to 65532, not 0
layout = "grid"
spacing = "1m"

[[island.group]]
#< `spacing` is missing in layout = "grid"
count = 2
layout = "grid"

[[island.group]]
count = 2
layout = "star"
#        ^ `layout` must be "grid", "line", "ring" or "disk", not "star"

[[island.group]]
count = 2
layout = "ring"
radius = "1m"
spacing = "1m"
#< unknown key `spacing` in layout = "ring": it is a key of layout = "grid", layout = "line"; see
#   rubicon check --explain spacing

[[island.group]]
count = 2
#       ^ mote ids from 65532 to 65533 are more than 65532
first = 65532
layout = "grid"
spacing = "1m"

[[island.group]]
count = 2
first = 1
#       ^ mote id 1 is the sink's
layout = "grid"
spacing = "1m"

[[island.group]]
count = 9
first = 2
layout = "grid"
spacing = "1m"
[[island.group]]
count = 9
first = 3
#       ^ mote id 3 is already taken (line 9, column 9)
layout = "grid"
spacing = "1m"

[[island.group]]
count = 2
prefix = "a b"
#        ^ `prefix` must be 1 to 26 letters, digits, - and _, not "a b"
layout = "grid"
spacing = "1m"

[[island.group]]
count = 2
name = "x"
#< unknown key `name` in layout = "grid": it is a key of [ecology], [[host]], [[quantity]], ...; see
#   rubicon check --explain name
layout = "grid"
spacing = "1m"

[[island.group]]
count = 60000
layout = "line"
#        ^ the layout reaches beyond 1000000 m
spacing = "100m"
)");
}

TEST_CASE("a group with the whole stack may be a chain of hops, and is told once if it breaks",
          "[config][GEN-06]") {
  const auto line = [](const std::string& spacing) {
    return "[[island.group]]\ntype = 1\ncount = 9\nlayout = \"line\"\nspacing = \"" + spacing +
           "\"\n";
  };
  CHECK(problem_after(island_head, line("10m")) == "none");
  CHECK(problem_after(island_head, line("30m")) == "none");
  CHECK(problem_after(island_head, line("31m")) == "18:10: mote `mote-3` is unreachable: no chain "
                                                   "of motes at most 30 m apart leads to its sink; "
                                                   "place it nearer, add motes between, or raise "
                                                   "`range` in [radio]");
}

TEST_CASE("all groups of a file have a limit together", "[config][GEN-06]") {
  std::string toml = "[ecology]\nname = \"t\"\n";
  for (int i = 1; i <= 2; ++i)
    toml += "[[island]]\nname = \"k" + std::to_string(i) + "\"\nid = " + std::to_string(i) +
            "\nstack = \"mac\"\n[[island.group]]\ncount = 60000\nlayout = \"grid\"\n"
            "spacing = \"1m\"\n";
  CHECK(problem_in(toml) ==
        "16:9: the groups of a file must not have more than 100000 motes together");
}
