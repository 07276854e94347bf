// Peers that are paused, killed, restarted and parted over and over: at the end everybody who is
// alive and reachable is known by its present incarnation.
#include <array>
#include <string>
#include <vector>

#include "core/numbers/random.hpp"
#include "ecology/ecology_files.hpp"
#include "support/catch.hpp"
#include "support/seeds.hpp"

using namespace rubicon;
using namespace rubicon::test;

namespace {

struct network {
  std::string_view name;
  std::string_view peers;              ///< tables
  std::vector<std::string_view> names; ///< that faults hit
};

const std::array<network, 5> networks{{
    {"a robot's components and Bluetooth peers",
     R"([[host]]
name = "h1"
address = "10.0.0.1"
[[peer]]
id = 1
name = "init"
host = "h1"
[[peer.apps]]
app = "init"
components = [{ name = "arm", peer = "arm" }, { name = "log", peer = "log", delay = "1s" }]
[[peer]]
id = 2
name = "arm"
host = "h1"
leaf = true
links = ["inproc://init"]
[[peer]]
id = 3
name = "log"
host = "h1"
leaf = true
links = ["inproc://init"]
[[peer]]
id = 5
name = "fridge"
[[peer]]
id = 8
name = "near"
bluetooth = ["hci0"]
position_m = [0, 0]
[[peer]]
id = 9
name = "far"
bluetooth = ["hci0"]
position_m = [4, 0]
wired = false
)",
     {"init", "fridge", "near", "far"}},
    {"a chain over Bluetooth",
     R"([[peer]]
id = 7
name = "a"
bluetooth = ["hci0"]
position_m = [0, 0]
wired = false
[[peer]]
id = 3
name = "b"
bluetooth = ["hci0"]
position_m = [8, 0]
wired = false
[[peer]]
id = 5
name = "c"
bluetooth = ["hci0"]
position_m = [16, 0]
[[peer]]
id = 2
name = "d"
[[peer]]
id = 9
name = "e"
)",
     {"a", "b", "c", "d", "e"}},
    {"a line of configured links",
     R"([[peer]]
id = 4
name = "a"
manager = false
links = ["inproc://b"]
[[peer]]
id = 2
name = "b"
manager = false
links = ["inproc://c"]
[[peer]]
id = 6
name = "c"
manager = false
links = ["inproc://d"]
[[peer]]
id = 1
name = "d"
manager = false
links = ["inproc://e"]
[[peer]]
id = 5
name = "e"
manager = false
discovery = false
)",
     {"a", "b", "c", "d", "e"}},
    {"a ring with a spur",
     R"([[peer]]
id = 4
name = "a"
manager = false
links = ["inproc://b"]
[[peer]]
id = 2
name = "b"
manager = false
links = ["inproc://c"]
[[peer]]
id = 6
name = "c"
manager = false
links = ["inproc://d"]
[[peer]]
id = 1
name = "d"
manager = false
links = ["inproc://a"]
[[peer]]
id = 5
name = "e"
manager = false
links = ["inproc://d"]
)",
     {"a", "b", "c", "d", "e"}},
    {"peers that find each other",
     R"([[peer]]
id = 10
name = "p"
count = 6
)",
     {"p-1", "p-2", "p-3", "p-4", "p-5", "p-6"}},
}};

std::string fault(const network& x, random_stream& rng) {
  constexpr std::array kinds{"pause", "kill", "power_off", "pause", "kill", "partition"};
  const auto uniform = [&](double from, double to) { return from + (to - from) * rng.unit(); };
  const auto one = [&] { return std::string(x.names[rng.below(x.names.size())]); };
  const std::string kind = kinds[rng.below(kinds.size())];
  const auto text = [](double s) { return '"' + std::to_string(s) + "s\"\n"; };
  const double at = uniform(20, 210);
  const double length = rng.below(3) == 0 ? uniform(0.01, 2) : uniform(2, 50);
  auto out = "[[fault]]\nat = " + text(at) + "kind = \"" + kind + "\"\nfor = " + text(length);
  if (kind == "partition")
    return out + "groups = [[\"" + one() + "\"]]\n";
  return out + "peer = \"" + one() + "\"\n";
}

std::string ecology_text(const network& x, std::uint64_t seed) {
  random_stream rng(seed, std::string(x.name));
  std::string text = "[ecology]\nname = \"restarts\"\nduration = \"7min\"\n";
  text += x.peers;
  const auto faults = 2 + rng.below(7);
  for (std::uint64_t i = 0; i < faults; ++i)
    text += fault(x, rng);
  return text;
}

void check_seeds(const network& x, std::uint64_t count) {
  for (std::uint64_t seed = 1; seed <= count; ++seed) {
    CAPTURE(x.name, seed);
    const auto text = ecology_text(x, seed);
    CHECK(told_violations(run(describe(text), seed)) == "");
  }
}

} // namespace

TEST_CASE("whoever is reachable is known as it is, after any restarts, pauses and partitions",
          "[ecology][KH-01][KH-02][KH-05][RTE-08]") {
  for (const auto& x : networks)
    check_seeds(x, seeds(20));
}

TEST_CASE("the same, hundreds of times", "[.][long]") {
  for (const auto& x : networks)
    check_seeds(x, 200);
}

TEST_CASE("of two peers with one id one leaves, is told so, and comes back when it is free",
          "[ecology][RTE-08][IF-12][ADR-02]") {
  const auto seed = GENERATE(1, 2, 3, 4, 5);
  const auto what = describe(R"(
[ecology]
name = "twins"
duration = "10min"
[[peer]]
id = 11
name = "pc"
[[peer]]
id = 20
name = "cup"
links = ["inproc://pc"]
[[peer]]
id = 30
name = "robot"
[[fault]]
at = "2min"
kind = "duplicate_id"
peer = "cup"
for = "5min"
)");
  const auto report = run(what, static_cast<std::uint64_t>(seed));
  CHECK(told_violations(report).empty());
  CHECK(has_logged(report, "cup", "its id is used by"));
  CHECK(has_logged(report, "cup-double-4", "its id is used by"));
  CHECK(has_logged(report, "cup-double-4", "leaves its id to"));
  CHECK(!has_logged(report, "cup", "leaves its id to"));
  for (const auto& peer : report.peers)
    CHECK(peer.links_opened < 60); // five stays of up to 8 s with a try a second
}
