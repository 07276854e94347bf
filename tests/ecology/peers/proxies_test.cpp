// What the tables of proxy classes promise, in whole ecologies: every value that is set is looked
// at.
#include <algorithm>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "config/load.hpp"
#include "ecology/ecology_files.hpp"
#include "ecology/faults/recorded.hpp"
#include "proxy/classes/program.hpp"
#include "support/catch.hpp"
#include "support/seeds.hpp"

using namespace rubicon;
using namespace rubicon::test;

namespace {

/// A kitchen with one mote of type 300, whose apps and proxy are given.
std::string kitchen(const std::string& mote, const std::string& proxy,
                    const std::string& more = {}) {
  return R"(
[ecology]
name = "proxies"
duration = "3min"
[radio]
range = "20m"
[[island]]
id = 1
name = "kitchen"
gateway.links = ["inproc://pc"]
[island.sink]
position_m = [1, 2, 3]
[[island.mote]]
id = 7
name = "board"
type = 300
position_m = [5, 0]
)" + mote +
         R"(
[[peer]]
id = 30
name = "pc"
apps = [{ app = "proxy_manager" }]
[[proxy]]
name = "board"
types = [300]
)" + proxy +
         more;
}

constexpr auto climate_mote = R"(
transducers.temperature = { model = "sine", mean = 22, amplitude = 5, period = "50s" }
transducers.humidity = { model = "constant", value = 45, resolution = 1 }
apps = [{ app = "sampler", transducers = ["temperature", "humidity"], every = "2s" }]
)";

constexpr auto climate_fields = R"(
[[proxy.field]]
name = "temperature"
channel = 1
scale = 0.1
unit = "C"
[[proxy.field]]
name = "humidity"
channel = 1
offset = 2
decimals = 0
unit = "%"
)";

} // namespace

TEST_CASE("templates of a class are tuples beside the usual ones", "[ecology][PXY-04][PXY-05]") {
  const auto x = run_recorded(describe(kitchen(climate_mote, std::string(climate_fields) + R"(
[[proxy.tuple]]
key = "{room}.climate"
json = ["temperature", "humidity"]
[[proxy.tuple]]
key = "{room}.words"
value = "{temperature} {temperature.unit} in {room}"
)")));
  const auto plain = x.at("kitchen.board.temperature");
  const auto json = x.at("kitchen.climate");
  const auto words = x.texts_at("kitchen.words");
  REQUIRE(plain.size() > 60);
  REQUIRE(json.size() == plain.size());
  REQUIRE(words.size() == plain.size());
  for (std::size_t i = 0; i < plain.size(); ++i) {
    CAPTURE(i);
    const auto object = nlohmann::json::parse(json[i].text);
    CHECK(object["temperature"]["value"].get<double>() == std::stod(plain[i].text));
    CHECK(object["temperature"]["unit"] == "C");
    CHECK(object["humidity"]["value"] == 45);
    const auto seconds = std::chrono::duration<double>(json[i].time.time_since_epoch()).count();
    CHECK(object["time"].get<double>() == Approx(seconds).margin(1e-5));
    CHECK(words[i] == plain[i].text + " C in kitchen");
  }
}

TEST_CASE("a mean moved from the mote to its proxy leaves all tuples as they are",
          "[ecology][PXY-17]") {
  const auto with = [](const std::string& place, std::uint64_t seed) {
    return run_recorded(describe(kitchen(R"(
transducers.temperature = { model = "sine", mean = 0, amplitude = 9, period = "40s", noise = 0.7 }
transducers.humidity = { model = "constant", value = 45, resolution = 1 }
apps = [{ app = "sampler", transducers = ["temperature", "humidity"], every = "2s" }]
)",
                                         R"(
[[proxy.field]]
name = "temperature"
channel = 1
scale = 0.1
unit = "C"
mean_of = 4
computed_by = ")" + place + R"("
[[proxy.field]]
name = "humidity"
channel = 1
offset = 2
decimals = 0
)")),
                        seed);
  };
  for (std::uint64_t seed = 1; seed <= seeds(3); ++seed) {
    CAPTURE(seed);
    const auto by_mote = with("mote", seed);
    const auto by_proxy = with("proxy", seed);
    const auto values = by_mote.at("kitchen.board.temperature");
    REQUIRE(values.size() > 60);
    CHECK(by_mote.texts_at("kitchen.board.temperature") ==
          by_proxy.texts_at("kitchen.board.temperature"));
    CHECK(by_mote.texts_at("kitchen.board.humidity") ==
          by_proxy.texts_at("kitchen.board.humidity"));
    // It is another computation that is shared: what the mote sends is not the same.
    CHECK(by_mote.texts_at("devices.7.output.1") != by_proxy.texts_at("devices.7.output.1"));
  }
}

TEST_CASE("a proxy tells through whom it perceives its mote, how well, and where",
          "[ecology][PXY-06][PXY-05]") {
  constexpr auto mote = R"(
transducers.temperature = { model = "constant", value = 21 }
apps = [{ app = "sampler", transducers = ["temperature", "signal"], every = "2s" }]
)";
  const std::string proxy = R"(
indirect = true
[[proxy.field]]
name = "rssi"
channel = 1
offset = 2
decimals = 0
unit = "dBm"
)";
  const auto x = run_recorded(describe(kitchen(mote, proxy)));
  CHECK(x.texts_at("kitchen.board.interface") == std::vector<std::string>{"kitchen-gateway"});
  CHECK(x.texts_at("kitchen.board.position") == std::vector<std::string>{"1.00 2.00 3.00"});
  CHECK(x.texts_at("kitchen.board.position.accuracy") == std::vector<std::string>{"interface"});
  const auto strengths = x.texts_at("kitchen.board.rssi");
  REQUIRE(strengths.size() > 60);
  for (const auto& each : strengths) { // a unit disk has one strength
    CHECK(std::stoi(each) < 0);
    CHECK(std::stoi(each) > -95);
  }

  const auto placed = run_recorded(describe(kitchen(mote, proxy, R"(
[[proxy.object]]
mote = "kitchen/board"
position_m = [5, 0.25]
properties = { shelf = "upper" }
[[fault]]
at = "60s"
kind = "battery_end"
mote = "kitchen/board"
)")));
  CHECK(placed.texts_at("kitchen.board.shelf") == std::vector<std::string>{"upper"});
  CHECK(placed.texts_at("kitchen.board.position") ==
        std::vector<std::string>{"5.00 0.25 0.00", "5.00 0.25 0.00"});
  CHECK(placed.texts_at("kitchen.board.position.accuracy") ==
        std::vector<std::string>{"prior", "prior"});
  CHECK(placed.texts_at("kitchen.board.interface") ==
        std::vector<std::string>{"kitchen-gateway", "none"});
}

TEST_CASE("the signal of a mote that is carried away grows weaker", "[ecology][PXY-06]") {
  auto text = kitchen(R"(
transducers.temperature = { model = "constant", value = 21 }
path = [["60s", [5, 0]], ["120s", [15, 0]]]
apps = [{ app = "sampler", transducers = ["signal"], every = "2s" }]
)",
                      R"(
[[proxy.field]]
name = "rssi"
channel = 1
decimals = 0
)");
  const auto disk = text.find("range = \"20m\"\n");
  text.replace(disk, 14, "propagation = { model = \"log_distance\", exponent = 3 }\n");
  const auto strengths = run_recorded(describe(text)).texts_at("kitchen.board.rssi");
  REQUIRE(strengths.size() > 60);
  CHECK(std::stoi(strengths.back()) < std::stoi(strengths[5]) - 8);
}

TEST_CASE("the outputs that a proxy reads come as often as its class asks for",
          "[ecology][GW-10][IF-04]") {
  constexpr auto mote = R"(
transducers.temperature = { model = "constant", value = 21 }
apps = [{ app = "sampler", transducers = ["temperature"], every = "20s", only_subscribed = true }]
)";
  const auto readings = [&](const std::string& quality) {
    return run_recorded(describe(kitchen(mote, quality + R"(
[[proxy.field]]
name = "temperature"
channel = 1
)",
                                         R"(
[[fault]]
at = "60s"
kind = "crash"
mote = "kitchen/board"
)")))
        .at("kitchen.board.temperature")
        .size();
  };
  const auto as_it_likes = readings({});
  CHECK(as_it_likes >= 5);
  CHECK(as_it_likes <= 9);
  CHECK(readings("qos = { period = \"1s\" }\n") > 130); // also after the crash
}

TEST_CASE("a proxy reads a stream of a mote in another island", "[ecology][PXY-18]") {
  const auto garden = [](const std::string& fault) {
    return kitchen(climate_mote, std::string(climate_fields) + R"(
[[proxy.field]]
name = "outside"
stream = 7
every = "2s"
scale = 0.1
unit = "C"
[[proxy.tuple]]
key = "weather"
value = "{outside} {outside.unit}"
)",
                   R"(
[[island]]
id = 2
name = "garden"
gateway.links = ["inproc://pc"]
[island.sink]
position_m = [101, 2]
[[island.mote]]
id = 3
name = "shed"
type = 301
position_m = [105, 0]
transducers.temperature = { model = "sine", mean = 4, amplitude = 9, period = "50s" }
apps = [{ app = "stream_writer", transducer = "temperature", to = "pc", stream = 7, every = "2s" }]
)" + fault);
  };
  for (std::uint64_t seed = 1; seed <= seeds(3); ++seed) {
    CAPTURE(seed);
    const auto x = run_recorded(describe(garden({})), seed);
    CHECK(x.report.violations.empty());
    REQUIRE(x.report.streams.size() == 1);
    const auto& stream = x.report.streams.front();
    CHECK(stream.from == "garden/shed");
    CHECK(stream.to == "pc");
    CHECK(stream.read > 60);
    CHECK(stream.missing == 0);
    const auto outside = x.texts_at("kitchen.board.outside");
    CHECK(outside.size() == stream.read);
    CHECK(x.texts_at("weather").size() == stream.read);
    CHECK(x.texts_at("kitchen.board.outside.unit") == std::vector<std::string>{"C"});
    CHECK(std::set<std::string>(outside.begin(), outside.end()).size() > 10);
    CHECK(x.texts_at("kitchen.board.temperature").size() > 60); // what its mote says goes on
  }

  // Whatever of them begins again, the stream opens anew.
  for (const auto* fault :
       {"kind = \"crash\"\nmote = \"garden/shed\"", "kind = \"kill\"\npeer = \"pc\"\nfor = \"5s\"",
        "kind = \"kill\"\npeer = \"garden-gateway\"\nfor = \"5s\""}) {
    CAPTURE(fault);
    const auto x =
        run_recorded(describe(garden("[[fault]]\nat = \"60s\"\n" + std::string(fault) + '\n')));
    CHECK(x.report.violations.empty());
    CHECK(x.at("kitchen.board.outside").back().time > instant(170s));
  }
}

TEST_CASE("a value that is not renewed is marked stale", "[ecology][PXY-20]") {
  const auto x = run_recorded(describe(kitchen(climate_mote, R"(
qos = { stale_after = "5s", inactive_after = "8s", retire_after = "30s" }
)" + std::string(climate_fields) + R"(
[[fault]]
at = "60s"
kind = "battery_end"
mote = "kitchen/board"
)")));
  const auto freshness = x.at("kitchen.board.temperature.freshness");
  const auto last = x.at("kitchen.board.temperature").back().time;
  REQUIRE(freshness.size() == 2);
  CHECK(freshness[0].text == "fresh");
  CHECK(freshness[1].text == "stale");
  CHECK(freshness[1].time == last + 5s);
  CHECK(x.texts_at("kitchen.board.humidity.freshness") ==
        std::vector<std::string>{"fresh", "stale"});
  // Inactive, then lost; 30 s later the proxy ends, and the report has it no more.
  const auto states = x.texts_at("kitchen.board.status");
  CHECK(std::vector<std::string>(states.end() - 2, states.end()) ==
        std::vector<std::string>{"inactive", "lost"});
  CHECK(x.report.proxies.empty());
}

TEST_CASE("an actuation is tried for as long as its class says", "[ecology][PXY-12]") {
  const auto outcomes = [](const std::string& quality) {
    return run_recorded(describe(kitchen(R"(
transducers.temperature = { model = "points", points = [["0s", 20.0], ["58s", 20.0], ["60s", 30.0]] }
actuators = [{ name = "fan", kind = "relay" }]
apps = [{ app = "sampler", transducers = ["temperature"], every = "1s" },
        { app = "actuator", actuator = "fan" }]
)",
                                         quality + R"(
[[proxy.field]]
name = "temperature"
channel = 1
scale = 0.1
[[proxy.input]]
name = "fan"
channel = 2
words = { on = "01" }
[[peer]]
id = 31
name = "robot"
links = ["inproc://pc"]
[[peer.apps]]
app = "rules"
retry = "0s"
rules = [{ when = "kitchen.board.temperature", above = 25, write = "kitchen.board.fan", then = "on", lasting = "20s" }]
[[fault]]
at = "70s"
kind = "unplug"
island = "kitchen"
for = "40s"
)")));
  };
  const auto once = outcomes({});
  const auto lasting = outcomes("qos = { retry_for = \"60s\", answer_timeout = \"10s\" }\n");
  const auto key = "kitchen.board.fan.outcome";
  REQUIRE(once.at(key).size() == 1);
  CHECK(once.at(key)[0].text != "on acknowledged");
  REQUIRE(lasting.at(key).size() == 1);
  CHECK(lasting.at(key)[0].text == "on acknowledged");
  CHECK(lasting.at(key)[0].time > instant(110s));
  CHECK(lasting.texts_at("kitchen.board.fan.deadline") ==
        std::vector<std::string>{"140.000000"}); // twice 60 s and 10 s
}

TEST_CASE("a number written to an input moves an actuator", "[ecology][PXY-12]") {
  const auto x = run_recorded(describe(kitchen(R"(
transducers.temperature = { model = "points", points = [["0s", 20.0], ["58s", 20.0], ["60s", 30.0]] }
actuators = [{ name = "lamp", kind = "dimmer" }]
apps = [{ app = "sampler", transducers = ["temperature"], every = "1s" },
        { app = "actuator", actuator = "lamp" }]
)",
                                               R"(
[[proxy.field]]
name = "temperature"
channel = 1
scale = 0.1
[[proxy.field]]
name = "level"
channel = 2
encoding = "u8"
decimals = 0
[[proxy.input]]
name = "lamp"
channel = 2
encoding = "u8"
scale = 0.5
max = 100
unit = "%"
[[peer]]
id = 31
name = "robot"
links = ["inproc://pc"]
[[peer.apps]]
app = "rules"
rules = [{ when = "kitchen.board.temperature", above = 25, write = "kitchen.board.lamp", then = "60" }]
)")));
  CHECK(x.texts_at("kitchen.board.lamp.outcome") == std::vector<std::string>{"60 acknowledged"});
  CHECK(x.texts_at("kitchen.board.level").back() == "120");
  CHECK(x.texts_at("kitchen.board.lamp.range") == std::vector<std::string>{"0 100"});
}

TEST_CASE("a program of a class says what no table can", "[ecology][PXY-04]") {
  const auto x = run_recorded(describe(kitchen(R"(
transducers.presence = { model = "points", points = [["0s", 0.0], ["60s", 0.0], ["61s", 1.0], ["70s", 1.0], ["71s", 0.0]], resolution = 1 }
apps = [{ app = "sampler", transducers = ["presence"], every = "1s" }]
)",
                                               R"(
program = "occupancy"
settings = { presence = 0.5, hold_s = 20 }
[[proxy.field]]
name = "presence"
channel = 1
)")));
  const auto occupied = x.at("kitchen.board.occupied");
  const auto presence = x.at("kitchen.board.presence");
  REQUIRE(occupied.size() == 3);
  CHECK(occupied[0].text == "no");
  CHECK(occupied[1].text == "yes");
  CHECK(occupied[2].text == "no");
  instant last;
  for (const auto& each : presence)
    last = each.text == "1.0" ? each.time : last;
  CHECK(occupied[2].time == last + 20s);
  CHECK(value(proxy_of(x.report, "kitchen.board"), "occupied") == "no");
}

namespace {

/// Counts the messages of its mote.
class counter final : public proxy::program {
public:
  [[nodiscard]] std::vector<std::string> names() const override { return {"messages"}; }
  [[nodiscard]] readings start(instant) override { return {{"messages", "0", ""}}; }
  [[nodiscard]] readings on_readings(const readings&, instant) override {
    return {{"messages", std::to_string(++count_), ""}};
  }

private:
  int count_ = 0;
};

} // namespace

TEST_CASE("a file may name any program of the registry that it is loaded with",
          "[ecology][PXY-04]") {
  auto programs = proxy::built_in_programs();
  REQUIRE(programs.add("counter", [](const proxy::proxy_class&, const proxy::program_settings&) {
    return proxy::program_factory([] { return std::make_unique<counter>(); });
  }));
  const auto text = kitchen(climate_mote, "program = \"counter\"\n" + std::string(climate_fields));
  const auto loaded = config::load_text(text, "test", {}, {}, {}, {programs});
  REQUIRE(loaded.ecology);
  const auto x = run_recorded(*loaded.ecology);
  const auto messages = x.texts_at("kitchen.board.messages");
  REQUIRE(messages.size() > 60);
  for (std::size_t i = 0; i < messages.size(); ++i)
    CHECK(messages[i] == std::to_string(i));
  CHECK(messages.size() == x.at("kitchen.board.temperature").size() + 1);
}

TEST_CASE("readings of ad0 become the kitchen's luminosity, with its history",
          "[ecology][SVC-09]") {
  const auto x = run_recorded(example("scenarios/translate.toml"));
  for (const auto* room : {"kitchen", "hall"}) {
    CAPTURE(room);
    const auto name = std::string(room);
    const auto counts = x.texts_at(name + ".board-7.ad0");
    const auto light = x.texts_at(name + ".luminosity");
    REQUIRE(counts.size() > 25);
    REQUIRE(light.size() + 1 >= counts.size()); // the last may still be in flight
    for (std::size_t i = 0; i < light.size(); ++i)
      CHECK(std::stod(light[i]) == Approx(0.5 * std::stod(counts[i])).margin(1e-9));
    CHECK(x.texts_at(name + ".luminosity.unit") == std::vector<std::string>{"lx"});
    const auto history = x.texts_at(name + ".luminosity.history").back();
    CHECK(std::ranges::count(history, '\n') == 20);
    CHECK(history.ends_with(',' + light.back() + '\n'));
  }
  const auto translate =
      std::ranges::find(x.report.programs, "translate", &report::program_report::kind);
  REQUIRE(translate != x.report.programs.end());
  CHECK(translate->figures.at(1) == std::pair<std::string, double>("tuples", 2));
}

TEST_CASE("two proxies with one key are told in the event log", "[ecology][PXY-15]") {
  const auto told = [](const std::string& prefix) {
    const auto x = run_recorded(describe(kitchen(climate_mote, prefix + climate_fields, R"(
[[island]]
id = 2
name = "cellar"
gateway.links = ["inproc://pc"]
[[island.mote]]
id = 7
name = "board"
type = 300
position_m = [5, 0]
)")));
    return std::ranges::count_if(x.report.event_log, [](const auto& line) {
      return line.what.ends_with("/board have the same key, board: a write to it reaches both");
    });
  };
  CHECK(told("") == 0);
  CHECK(told("prefix = \"{name}\"\n") == 1);
}
