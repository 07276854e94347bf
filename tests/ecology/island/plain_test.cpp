// A simulated base station with plain motes of TinyOS around it, and radios with channels and
// medium access of their own.
#include <cstdint>
#include <map>
#include <string>

#include "ecology/ecology_files.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::test;

namespace {

/// A kitchen with a base station, an oscilloscope and two counters, whose packets a gateway turns
/// into tuples, and a proxy manager. @param more tables behind it
std::string kitchen(const std::string& more = {}) {
  return R"(
[ecology]
name = "plain"
duration = "60s"
[[peer]]
name = "pc"
id = 300
links = ["inproc://kitchen-gateway"]
[[peer.apps]]
app = "proxy_manager"
[[peer.apps]]
app = "rules"
retry = "0s"
rules = [
  { when = "kitchen.lamp.count", above = 40, write = "kitchen.scope.interval", then = "100" },
]
[[proxy]]
name = "scope"
types = [905]
field = [{ name = "first", channel = 1, encoding = "u16", offset = 8, decimals = 0 },
         { name = "every", channel = 1, encoding = "u16", offset = 2, decimals = 0 },
         { name = "version", channel = 1, encoding = "u16", offset = 0, decimals = 0 }]
input = [{ name = "interval", channel = 2, encoding = "u16", unit = "ms" }]
[[proxy]]
name = "blinker"
types = [901]
field = [{ name = "count", channel = 1, encoding = "u16", offset = 2, decimals = 0 }]
[[island]]
id = 20
name = "kitchen"
sink = { role = "base_station", position_m = [0, 0] }
plain = [{ am_type = 147, type = 905, input = 2, input_form = "oscilloscope" },
         { am_type = 6, type = 901 }]
[[island.mote]]
id = 2
name = "scope"
position_m = [3, 0]
transducers.light = { model = "constant", value = 120, resolution = 0.1 }
apps = [{ app = "oscilloscope", transducer = "light", every = "200ms" }]
[[island.mote]]
id = 3
name = "lamp"
position_m = [0, 3]
apps = [{ app = "blink", every = "500ms" }]
[[island.mote]]
id = 4
name = "far"
position_m = [500, 0]
apps = [{ app = "blink" }]
)" + more;
}

std::map<std::string, report::cause_counts> modules_of(const report::run_report& x) {
  std::map<std::string, report::cause_counts> all;
  for (const auto& each : x.modules)
    all[each.who] = each.counters;
  return all;
}

} // namespace

TEST_CASE("a gateway turns packets of simulated plain motes into tuples",
          "[ecology][tinyos][GW-17]") {
  ecology x(kitchen());
  x.run_for(100ms);
  CHECK(x.run_until([&] { return x.tuple("pc", "kitchen.lamp.count").has_value(); }, 5s));
  x.run_for(5s);
  CHECK(x.tuple("pc", "kitchen.scope.first") == "1200");
  CHECK(x.tuple("pc", "kitchen.scope.every") == "200");
  CHECK(x.tuple("pc", "kitchen.scope.version") == "0");
  CHECK(!x.tuple("pc", "kitchen.far.count")); // out of reach of the base station
  CHECK(x.logged("kitchen/scope", "joined"));
  // The rule writes an interval when the lamp has counted to 40: a packet of Oscilloscope goes over
  // line and air, and the mote goes on as it says.
  REQUIRE(x.run_until([&] { return x.tuple("pc", "kitchen.scope.version") == "1"; }, 30s));
  CHECK(x.tuple("pc", "kitchen.scope.every") == "100");
  const auto report = x.finish();
  CHECK(report.violations.empty());
  auto modules = modules_of(report);
  CHECK(modules["kitchen/scope"]["oscilloscope.settings"] == 1);
  CHECK(modules["kitchen/lamp"]["blink.packets"] >= 115);
  CHECK(modules["sink/kitchen"]["base_station.down_sent"] >= 1);
  const auto& real = report.islands.at(0).real;
  CHECK(real.taken > 115);
  CHECK(modules["sink/kitchen"]["base_station.up"] >= real.packets);
  for (const auto& mote : report.islands.at(0).motes)
    CHECK(!mote.joins);
}

TEST_CASE("a base station that crashes passes on again when it is back",
          "[ecology][tinyos][GW-15][GW-17]") {
  ecology x(kitchen("[[fault]]\nat = \"20s\"\nkind = \"crash\"\nsink = \"kitchen\"\nfor = \"4s\"\n"
                    "[[fault]]\nat = \"30s\"\nkind = \"crash\"\nmote = \"kitchen/lamp\"\n"
                    "for = \"3s\"\n"));
  x.run_until(instant(19s));
  const auto before = x.tuple("pc", "kitchen.lamp.count");
  REQUIRE(before);
  x.run_until(instant(28s));
  const auto after = x.tuple("pc", "kitchen.lamp.count");
  REQUIRE(after);
  CHECK(std::stoi(*after) >= std::stoi(*before) + 8);
  x.run_until(instant(36s));
  REQUIRE(x.tuple("pc", "kitchen.lamp.count"));
  CHECK(std::stoi(*x.tuple("pc", "kitchen.lamp.count")) < 12); // another life counts from 1
  CHECK(x.finish().violations.empty());
}

TEST_CASE("a plain run is the same each time", "[ecology][tinyos][GEN-07]") {
  const auto a = run(describe(kitchen()), 7);
  const auto b = run(describe(kitchen()), 7);
  const auto c = run(describe(kitchen()), 8);
  CHECK(a.trace_hash == b.trace_hash);
  CHECK(a.trace_hash != c.trace_hash);
}

TEST_CASE("islands of one air on different channels do not disturb each other",
          "[ecology][radio][NET-15]") {
  const auto lost = [](const std::string& channel) {
    const auto island = [&](int id, const std::string& on) {
      const auto number = std::to_string(id);
      return "[[island]]\nid = " + number + "\nname = \"lab-" + number + "\"\nstack = \"mac\"\n" +
             on +
             "sink.apps = [{ app = \"receiver\" }]\n"
             "[[island.group]]\ncount = 8\nlayout = \"ring\"\nradius = \"5m\"\n"
             "apps = [{ app = \"sender\", to = \"sink\", pattern = \"poisson\", every = \"40ms\" "
             "}]\n";
    };
    const auto x = run(describe("[ecology]\nname = \"labs\"\nduration = \"20s\"\n"
                                "[[air]]\nname = \"hall\"\nislands = [\"lab-1\", \"lab-2\"]\n" +
                                island(1, "") + island(2, channel)));
    CHECK(x.violations.empty());
    std::uint64_t sum = 0;
    for (const auto& each : x.islands) {
      sum += each.radio.lost.contains("collision") ? each.radio.lost.at("collision") : 0;
      sum += each.radio.mac_failed.contains("channel_access_failure")
                 ? each.radio.mac_failed.at("channel_access_failure")
                 : 0;
    }
    return sum;
  };
  const auto shared = lost("");
  const auto apart = lost("channel = 15\n");
  CHECK(shared > 3 * apart);
}
