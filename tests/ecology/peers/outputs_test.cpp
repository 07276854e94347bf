// Motes send what somebody subscribes to, and as often as somebody wants (GW-10, IF-03, IF-04).
#include <map>
#include <string>

#include "ecology/ecology_files.hpp"
#include "support/catch.hpp"
#include "support/seeds.hpp"

using namespace rubicon;
using namespace rubicon::test;

namespace {

/// Ten motes that send only on request, and a robot that reads them from another computer.
std::string reading_room(const std::string& collector, const std::string& faults = {}) {
  return R"(
[ecology]
name = "reading-room"
duration = "2min"
[radio]
range = "30m"
[[island]]
id = 1
name = "room"
gateway.links = ["inproc://pc"]
[island.sink]
position_m = [0, 0]
[[island.group]]
count = 10
layout = "ring"
radius = "10m"
prefix = "shelf"
type = 10
transducers.light = { model = "sine", mean = 100, amplitude = 100, period = "10s" }
apps = [{ app = "sampler", transducers = ["light"], every = "1s", only_subscribed = true }]
[[peer]]
id = 12
name = "pc"
[[peer]]
id = 30
name = "robot"
links = ["inproc://pc"]
apps = [{ app = "collector", )" +
         collector + " }]\n" + faults;
}

std::uint64_t readings(const std::string& collector, const std::string& faults = {},
                       std::uint64_t seed = 1) {
  const auto x = run(describe(reading_room(collector, faults)), seed);
  CHECK(x.violations.empty());
  return x.islands.at(0).messages.unreliable_sent;
}

} // namespace

TEST_CASE("anybody finds all motes of all islands by one pattern", "[ecology][DIS-04][TUP-08]") {
  std::string three;
  for (const int island : {1, 2, 3}) {
    const auto number = std::to_string(island);
    three += "[[island]]\nid = " + number + "\nname = \"room-" + number +
             "\"\ngateway.links = [\"inproc://pc\"]\nsink.position_m = [0, 0]\n"
             "[[island.group]]\ncount = 4\nlayout = \"ring\"\nradius = \"5m\"\ntype = 1\n";
  }
  const auto x = run(describe("[ecology]\nname = \"rooms\"\nduration = \"30s\"\n" + three + R"(
[[peer]]
id = 12
name = "pc"
[[peer]]
id = 30
name = "robot"
links = ["inproc://pc"]
apps = [{ app = "collector", keys = ["devices.*.type"] }]
)"));
  CHECK(x.motes_joined() == 12);
  CHECK(x.programs.at(0).kind == "collector");
  CHECK(x.programs.at(0).figures.at(1) == std::pair<std::string, double>("tuples", 12));
}

TEST_CASE("motes send what somebody subscribes to, all of them, and nothing else",
          "[ecology][GW-10][IF-03]") {
  for (std::uint64_t seed = 1; seed <= seeds(3); ++seed) {
    CAPTURE(seed);
    CHECK(readings(R"(keys = ["a.b"])", {}, seed) == 0);
    CHECK(readings(R"(keys = ["*.*.*.*", "devices.*.type", "devices.*.output.2"])", {}, seed) == 0);
    const auto of_all = readings(R"(keys = ["devices.*.output.1"])", {}, seed);
    CHECK(of_all > 10 * 110);
    CHECK(of_all <= 10 * 120);
    const auto of_one = readings(R"(keys = ["devices.3.output.*"])", {}, seed);
    CHECK(of_one > 110);
    CHECK(of_one <= 120);
  }
}

TEST_CASE("the client says how often it wants to hear of motes, also of a gateway started again",
          "[ecology][IF-04]") {
  constexpr auto collector = R"(keys = ["devices.*.output.1"], every = "250ms")";
  const auto all = readings(collector);
  CHECK(all > 4 * 10 * 110);
  CHECK(all <= 4 * 10 * 120);
  // Motes go on as they were told; the new gateway hears anew what is wanted.
  const auto interrupted = readings(collector, R"(
[[fault]]
at = "30s"
kind = "kill"
peer = "room-gateway"
for = "10s"
)");
  CHECK(interrupted > 4 * 10 * 110);
  CHECK(interrupted <= 4 * 10 * 120);
}

TEST_CASE("motes stop sending when the last subscriber has gone", "[ecology][GW-10]") {
  const auto sent = readings(R"(keys = ["devices.*.output.1"])", R"(
[[fault]]
at = "30s"
kind = "kill"
peer = "robot"
)");
  CHECK(sent > 10 * 25);
  CHECK(sent < 10 * 80);
}
