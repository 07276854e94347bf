#include <string>

#include "config/checks/tuple_keys.hpp"
#include "config/checks/warnings.hpp"
#include "config/checks/window_room.hpp"
#include "config/listing.hpp"
#include "support/catch.hpp"
#include "unit/config/sample.hpp"

using namespace rubicon;
using namespace rubicon::config;
using namespace rubicon::test;

namespace {

/// An island `k` with a mote `c-2` of type 7 that sends a temperature on channel 1, its proxy with
/// the field `temperature`, and what a peer `pc` does beside managing proxies.
std::string home_with(const std::string& field, const std::string& app = "") {
  return "[ecology]\nname = 't'\n"
         "[mote_type.c]\ntype = 7\n"
         "transducers.temperature = { model = 'constant', value = 20 }\n"
         "apps = [{ app = 'sampler', transducers = ['temperature'] }]\n"
         "[[island]]\nname = 'k'\nid = 1\ngateway.links = ['inproc://pc']\n"
         "[[island.mote]]\nid = 2\ntype = 'c'\nposition_m = [1, 2]\n"
         "[[peer]]\nname = 'pc'\nid = 30\napps = [{ app = 'proxy_manager' }" +
         app + "]\n[[proxy]]\nname = 'p'\ntypes = [7]\n[[proxy.field]]\nname = 'temperature'\n" +
         field;
}

/// All of a file that has no problems, with what it names.
std::vector<problem> placed_warnings_of(const std::string& toml, const file_reader& files = {}) {
  const auto x = load_text(toml, "t.toml", {}, files);
  for (const auto& each : x.problems)
    FAIL_CHECK(to_string(each));
  return warnings_of(x, "t.toml");
}

std::vector<std::string> warnings_of(const std::string& toml) {
  std::vector<std::string> out;
  for (const auto& each : placed_warnings_of(toml))
    out.push_back(each.message);
  return out;
}

/// One of `warnings_of`, or all of them in one text.
std::string warning_of(const std::string& toml) {
  std::string out;
  for (const auto& each : placed_warnings_of(toml))
    out += (out.empty() ? "" : "\n") + to_string(each);
  return out;
}

/// What is to be said of an island of `motes` around their sink, with what follows its name.
std::vector<problem> warnings_of_island(int motes, const std::string& island,
                                        const std::string& every = "30s") {
  std::string toml = "[ecology]\nname = 't'\n[radio.propagation]\nmodel = 'log_distance'\n"
                     "[mote_type.c]\ntype = 7\n"
                     "transducers.temperature = { model = 'constant', value = 20 }\n"
                     "apps = [{ app = 'sampler', transducers = ['temperature'], every = '" +
                     every + "' }]\n[[island]]\nname = 'k'\nid = 1\n" + island +
                     "[[island.group]]\ntype = 'c'\ncount = " + std::to_string(motes) +
                     "\nlayout = 'disk'\nradius = '10m'\n";
  const auto x = load_text(toml, "t.toml");
  for (const auto& each : x.problems)
    FAIL_CHECK(to_string(each));
  return x.warnings;
}

} // namespace

TEST_CASE("a mote may be silent for three periods of the windows", "[config][DIS-06][NRG-01]") {
  const auto warnings = warnings_of_island(
      2, "keep_alive = '29s'\nduty_cycle = { period = '10s', window = '100ms' }\n");
  REQUIRE(warnings.size() == 1);
  CHECK(to_string(warnings[0]) ==
        "t.toml:12:14: `keep_alive` is 29 s, but motes whose radios sleep are received once in a "
        "period of 10 s: they are removed after three of these, 30 s");
  const auto count = [](const std::string& island) { return warnings_of_island(2, island).size(); };
  CHECK(count("keep_alive = '30s'\nduty_cycle = { period = '10s', window = '100ms' }\n") == 0);
  CHECK(count("duty_cycle = { period = '10s', window = '100ms' }\n") == 1); // 10 s by default
  CHECK(count("duty_cycle = { period = '9s', window = '100ms' }\n") == 0);
  CHECK(count("keep_alive = '1s'\n") == 0); // nobody sleeps
}

TEST_CASE("windows have room for those who share them", "[config][NRG-01]") {
  const auto said = [](int motes, const std::string& window, const std::string& every = "30s") {
    const auto warnings = warnings_of_island(
        motes, "duty_cycle = { period = '2s', window = '" + window + "' }\n", every);
    return warnings.empty() ? std::string() : to_string(warnings.at(0));
  };
  CHECK(said(50, "100ms") == "t.toml:12:40: a window of 100 ms has room for 15 beacons, but 51 "
                             "motes in range of each other share it: after a restart of the sink "
                             "they are missing for a long time; 340 ms would do");
  CHECK(said(50, "340ms").empty());
  CHECK_FALSE(said(50, "330ms").empty());
  CHECK(said(14, "100ms").empty());
  CHECK_FALSE(said(15, "100ms").empty());
  CHECK(said(14, "100ms", "1s")
            .find("carries about 6.7 packets over 1 hop, but the programs of "
                  "the island send 28.0 per window, answers included") != std::string::npos);
  CHECK(said(3, "100ms", "1s").empty());
  CHECK_FALSE(said(4, "100ms", "1s").empty());
  const auto crowd = said(300, "1s");
  CHECK(crowd.find("with a period of 3.94 s at least") != std::string::npos);
}

TEST_CASE("the radio of a sink carries so many messages a second", "[config]") {
  const auto warnings = warnings_of_island(254, "", "2s");
  REQUIRE(warnings.size() == 1);
  CHECK(to_string(warnings[0]) ==
        "t.toml:11:6: its motes send 127 messages per second, but the radio of a sink carries "
        "about 85: many are lost, and motes are considered lost; periods 2 times as long would do");
  CHECK(warnings_of_island(170, "", "2s").empty());
  CHECK(warnings_of_island(171, "", "2s").size() == 1);
}

TEST_CASE("only those who hear each other share a window", "[config][NRG-01]") {
  std::string toml = "[ecology]\nname = 't'\n[radio]\nrange = '30m'\n[[island]]\nname = 'k'\n"
                     "id = 1\nduty_cycle = { period = '2s', window = '100ms' }\n";
  for (int i = 1; i <= 60; ++i) // a line, in which each hears one to either side
    toml += "[[island.mote]]\nid = " + std::to_string(i + 1) + "\ntype = 7\nposition_m = [" +
            std::to_string(25 * i) + ", 0]\n";
  CHECK(load_text(toml, "t.toml").warnings.empty());
}

TEST_CASE("a window carries less over many hops, and less with loss", "[config][NRG-01]") {
  CHECK(packets_in(100ms, 1, 0) == Approx(6.67).epsilon(0.01));
  CHECK(packets_in(100ms, 3, 0) == packets_in(100ms, 1, 0));
  CHECK(packets_in(200ms, 6, 0) == Approx(8.7).epsilon(0.01));
  CHECK(packets_in(200ms, 6, 0.1) == Approx(7.04).epsilon(0.01));
  CHECK(packets_in(200ms, 60, 0) == packets_in(200ms, 8, 0));
  for (const auto hops : {1U, 4U, 8U})
    for (const auto loss : {0.0, 0.2})
      for (const auto packets : {0.5, 3.0, 20.0}) {
        const auto window = window_for(packets, hops, loss);
        CHECK(packets_in(window, hops, loss) >= packets);
        CHECK(packets_in(window - 10ms, hops, loss) < packets);
      }
}

TEST_CASE("streams to elsewhere and answers take a part of each window", "[config][NRG-01]") {
  const auto said = [](const std::string& apps, const std::string& period) {
    std::string toml = "[ecology]\nname = 't'\n[radio]\nrange = '25m'\n"
                       "[mote_type.c]\ntype = 7\ntransducers.temperature = { model = 'constant', "
                       "value = 1 }\napps = [" +
                       apps +
                       "]\n[[island]]\nname = 'k'\nid = 1\nkeep_alive = '2min'\n"
                       "duty_cycle = { period = '" +
                       period + "', window = '100ms' }\n[[peer]]\nid = 40\nname = 'pc'\n";
    for (int i = 1; i <= 6; ++i)
      toml += "[[island.mote]]\nid = " + std::to_string(i + 1) + "\ntype = 'c'\nposition_m = [" +
              std::to_string(20 * i) + ", 0]\n";
    const auto x = load_text(toml, "t.toml");
    for (const auto& each : x.problems)
      FAIL_CHECK(to_string(each));
    return x.warnings.empty() ? std::string() : to_string(x.warnings.at(0));
  };
  const std::string sampler = "{ app = 'sampler', transducers = ['temperature'], every = '60s'";
  const std::string stream = "{ app = 'stream_writer', transducer = 'temperature', stream = 1, "
                             "every = '60s', to = 'pc' }";
  CHECK(said(sampler + " }", "30s").empty());
  CHECK(said(sampler + ", reliable = true }", "10s").empty());
  CHECK_FALSE(said(sampler + ", reliable = true }", "30s").empty());
  CHECK_FALSE(said(stream, "10s").empty());
}

TEST_CASE("patterns of keys match without letter case", "[config]") {
  CHECK(may_be("a.b", "A.B"));
  CHECK(may_be("a.*", "a.b"));
  CHECK(may_be("a.b", "a.*"));
  CHECK(may_be("a.**", "a.b.c"));
  CHECK_FALSE(may_be("a.**", "a"));
  CHECK_FALSE(may_be("a.b", "a.b.c"));
  CHECK_FALSE(may_be("a.b.c", "a.b"));
}

TEST_CASE("a good file has no warnings", "[config]") {
  CHECK(warnings_of(
            home_with("channel = 1\n",
                      ", { app = 'collector', keys = ['k.*.temperature', 'devices.*.type'] }"))
            .empty());
}

TEST_CASE("what reads or writes a tuple that no component publishes cannot work", "[config]") {
  CHECK(warnings_of(
            home_with("channel = 1\n", ", { app = 'collector', keys = ['k.c-2.temprature'] }")) ==
        std::vector<std::string>{"the collector of pc reads `k.c-2.temprature`, a tuple that no "
                                 "component publishes: did you mean `k.c-2.temperature`?"});
  const auto rule = warnings_of(
      home_with("channel = 1\n", ", { app = 'rules', rules = [{ when = 'k.c-2.temperature', "
                                 "above = 1, write = 'k.lamp.switch', then = 'on' }] }"));
  REQUIRE(rule.size() == 1);
  CHECK(rule[0].starts_with(
      "a rule of pc writes `k.lamp.switch`, a tuple that no component publishes"));
  CHECK(warnings_of(home_with("channel = 1\n",
                              ", { app = 'translate', rules = [{ from = 'x.y', "
                              "to = 'x.z' }] }, { app = 'collector', keys = ['x.z'] }"))
            .size() == 1);
}

TEST_CASE("a peer of another process may have any tuple", "[config]") {
  auto toml = home_with("channel = 1\n", ", { app = 'collector', keys = ['x.y'] }");
  CHECK(warnings_of(toml).size() == 1);
  toml.insert(toml.find("name = 't'"), "mode = 'wall'\n");
  toml.insert(toml.find("id = 30"), "tcp = true\n");
  CHECK(warnings_of(toml).empty());
}

TEST_CASE("a field needs a program that sends it, and enough octets", "[config]") {
  CHECK(warnings_of(home_with("channel = 3\n")) ==
        std::vector<std::string>{"field `temperature` of [[proxy]] `p`: no program of motes of "
                                 "type c sends on channel 3"});
  CHECK(warnings_of(home_with("channel = 1\noffset = 1\n")) ==
        std::vector<std::string>{"field `temperature` of [[proxy]] `p` ends at octet 3, but "
                                 "messages of motes of type c on channel 1 have 2 of counts"});
  const auto input =
      warnings_of(home_with("channel = 1\n[[proxy.input]]\nname = 'switch'\nchannel = 2\n"
                            "words = { on = '01' }\n"));
  CHECK(input == std::vector<std::string>{"input `switch` of [[proxy]] `p`: no program of motes "
                                          "of type c listens on channel 2"});
}

TEST_CASE("messages need a program that takes their AM type", "[config][AM-01]") {
  const auto with = [](const std::string& program) {
    return warnings_of(
        home_with("channel = 1\n") +
        "[[island]]\nname = 'far'\nid = 2\n[[island.mote]]\nid = 5\nname = 'to'\n"
        "type = 'c'\nposition_m = [1, 2]\napps = [" +
        program +
        "]\n[[island.mote]]\nid = 6\nname = 'from'\ntype = 'c'\n"
        "position_m = [1, 3]\napps = [{ app = 'messenger', to = 'far/to', text = 'hm', "
        "every = '1s' }]\n");
  };
  CHECK(with("{ app = 'listener', am_type = 10 }").empty());
  const std::vector<std::string> nobody{
      "far/from sends messages of AM type 10 to far/to, where no program accepts them"};
  CHECK(with("") == nobody);
  CHECK(with("{ app = 'listener', am_type = 11 }") == nobody);
}

namespace {

/// Three motes, of which one may be another mote later, with these programs, a PC with this one,
/// and the rest of the file.
std::vector<std::string> warnings_of_streams(const std::vector<std::string>& motes,
                                             const std::string& pc, const std::string& rest = "") {
  std::string toml = "[ecology]\nname = 'e'\n[mote_type.c]\ntype = 7\n"
                     "transducers.light = { model = 'constant', value = 1 }\n[mote_type.w]\n"
                     "type = 8\ntransducers.light = { model = 'constant', value = 1 }\n"
                     "apps = [{ app = 'stream_writer', transducer = 'light', to = 'pc' }]\n"
                     "[[island]]\nid = 1\nname = 'k'\n";
  for (std::size_t i = 0; i < motes.size(); ++i)
    toml += "[[island.mote]]\nid = " + std::to_string(i + 2) + "\nname = 'm" + std::to_string(i) +
            "'\ntype = 'c'\nposition_m = [1, " + std::to_string(i) + "]\napps = [" + motes[i] +
            "]\n";
  return warnings_of(toml +
                     "[[island]]\nid = 2\nname = 'far'\n[[peer]]\nid = 40\nname = 'pc'\napps = [" +
                     pc + "]\n" + rest);
}

std::string writer_to(const std::string& to, int stream = 1) {
  return "{ app = 'stream_writer', transducer = 'light', to = '" + to +
         "', stream = " + std::to_string(stream) + " }";
}

std::string reader_of(int stream) {
  return "{ app = 'stream_reader', stream = " + std::to_string(stream) + " }";
}

} // namespace

TEST_CASE("a stream needs a program that reads it", "[config][STR-11]") {
  CHECK(warnings_of_streams({writer_to("pc")}, reader_of(1)).empty());
  CHECK(warnings_of_streams({writer_to("pc")}, "{ app = 'recorder', streams = [1], file = 'f' }")
            .empty());
  CHECK(warnings_of_streams({writer_to("k/m1"), reader_of(1)}, "").empty());
  const std::vector<std::string> nobody{"k/m0 writes stream 1 to pc, where no program reads it"};
  CHECK(warnings_of_streams({writer_to("pc")}, "") == nobody);
  CHECK(warnings_of_streams({writer_to("pc"), reader_of(1)}, "") ==
        std::vector<std::string>{nobody[0], "k/m1 reads stream 1, which no program writes to it"});
  CHECK(warnings_of_streams({writer_to("k/m0"), reader_of(1)}, "").front() ==
        "k/m0 writes stream 1 to itself: it needs another node to read it");
}

TEST_CASE("a stream needs one program that writes it", "[config][STR-11]") {
  CHECK(warnings_of_streams({""}, reader_of(3)) ==
        std::vector<std::string>{"pc reads stream 3, which no program writes to it"});
  CHECK(warnings_of_streams({writer_to("pc"), writer_to("pc")}, reader_of(1)) ==
        std::vector<std::string>{"k/m0 and k/m1 write stream 1 to pc, which reads one of a number: "
                                 "each needs a `stream` of its own"});
  CHECK(warnings_of_streams({writer_to("pc"), writer_to("pc"), writer_to("pc")}, reader_of(1)) ==
        std::vector<std::string>{"k/m0, k/m1 and 1 more write stream 1 to pc, which reads one of a "
                                 "number: each needs a `stream` of its own"});
  CHECK(
      warnings_of_streams({writer_to("pc"), writer_to("pc", 2)}, reader_of(1) + ", " + reader_of(2))
          .empty());
}

TEST_CASE("motes may read and write a stream in turns", "[config][STR-11]") {
  const std::string becomes = "[[fault]]\nat = '1s'\nkind = 'crash'\nmote = 'k/m1'\ntype = 'w'\n";
  CHECK(warnings_of_streams({""}, reader_of(1)).size() == 1);
  CHECK(warnings_of_streams({"", ""}, reader_of(1), becomes).empty());
  CHECK(warnings_of_streams({writer_to("pc"), ""}, reader_of(1), becomes).empty());
  CHECK(warnings_of_streams({writer_to("pc"), writer_to("pc")}, reader_of(1),
                            "[[fault]]\nat = '1s'\nkind = 'battery_end'\nmote = 'k/m1'\n")
            .empty());
  CHECK(warnings_of_streams({writer_to("k/m1"), reader_of(1)}, "",
                            "[[fault]]\nat = '1s'\nkind = 'move'\nmote = 'k/m1'\n"
                            "to_island = 'far'\nto_m = [99, 0]\n")
            .empty());
}

TEST_CASE("a type that nobody claims is told of once", "[config]") {
  auto toml = home_with("channel = 1\n");
  toml.replace(toml.find("types = [7]"), 11, "types = [8]");
  toml.insert(toml.find("[[peer]]"), "[[island.mote]]\nid = 3\ntype = 'c'\nposition_m = [1, 2]\n");
  const auto found = warnings_of(toml);
  REQUIRE(found.size() == 1);
  CHECK(found[0] == "no [[proxy]] claims motes of type c (7), as k/c-2 is one");
}

TEST_CASE("the list has motes, peers and tuples", "[config]") {
  const auto text = listing(good(home_with("channel = 1\nunit = 'C'\n")));
  CHECK(text.find("  k/c-2   1/2  type 7 (c), proxy p\n") != std::string::npos);
  CHECK(text.find("  k-gateway  1   gateway of k\n") != std::string::npos);
  CHECK(text.find("k.c-2.temperature.unit") != std::string::npos);
  CHECK(text.find("devices.**") != std::string::npos);
}

namespace {

/// The flat of a lamp, a blind and a robot. What `pc` does with them is on line 2, what is expected
/// of them on line 1.
std::string flat(const std::string& rules, const std::string& expect = "[]") {
  return "expect = " + expect +
         "\npeer = [{ name = 'pc', id = 30, links = ['inproc://k-gateway'], " +
         "apps = [{ app = 'proxy_manager' }" +
         (rules.empty() ? "" : ", { app = 'rules', rules = [" + rules + "] }") +
         "] }, { name = 'robot', id = 31, links = ['inproc://pc'], apps = [{ app = 'goal', "
         "outputs = [{ name = 'hand', value = 'empty' }], "
         "inputs = [{ name = 'lamp', from = 'pc:k.lamp-2.state' }], "
         "goals = [{ goal = 'at bed', states = [{ state = 'driving', for = '2s', "
         "sets = { hand = 'full' } }] }] }] }]\n" +
         R"([ecology]
name = 't'
[mote_type.lamp]
type = 200
actuators = [{ name = 'bulb', kind = 'relay' }, { name = 'spot', kind = 'dimmer' }]
transducers.temperature = { model = 'random_walk', start = 20, step = 1, min = 15, max = 25 }
transducers.presence = { model = 'constant', value = 1, resolution = 1 }
apps = [{ app = 'actuator', actuator = 'bulb' }, { app = 'actuator', actuator = 'spot', channel = 3 },
        { app = 'sampler', transducers = ['temperature', 'presence'] }]
[[island]]
name = 'k'
id = 1
mote = [{ id = 2, type = 'lamp', position_m = [1, 0] }]
[[proxy]]
name = 'lamp'
types = [200]
properties = { room = 'hall' }
qos = { stale_after = '5min' }
field = [
  { name = 'state', channel = 2, encoding = 'u8', words = { 0 = 'off', 1 = 'on' } },
  { name = 'level', channel = 3, encoding = 'u8', words = { 0 = 'dark' } },
  { name = 'temperature', channel = 1, transducer = 'temperature' },
  { name = 'presence', channel = 1, transducer = 'presence', words = { 0 = 'empty', 1 = 'there' } },
]
input = [
  { name = 'switch', channel = 2, words = { on = '01', off = '00' } },
  { name = 'dim', channel = 3, words = { full = 'ff' }, encoding = 'u8', scale = 0.392157, min = 0, max = 100, unit = '%' },
]
)";
}

std::string rule(const std::string& condition, const std::string& write = "k.lamp-2.switch",
                 const std::string& then = "on") {
  return "{ " + condition + ", write = '" + write + "', then = '" + then + "' }";
}

std::string wanted(const std::string& condition) {
  return "[{ kind = 'tuple', " + condition + ", within = '1min' }]";
}

} // namespace

TEST_CASE("a rule writes what somebody takes", "[config][PXY-12]") {
  const auto told = [](const std::string& key, const std::string& word) {
    const auto found = warnings_of(flat(rule("at = '08:00'", key, word)));
    return found.empty() ? std::string() : found.size() > 1 ? "several" : found[0];
  };
  CHECK(told("k.lamp-2.switch", "on").empty());
  CHECK(told("K.Lamp-2.Switch", "off").empty());
  CHECK(told("k.lamp-2.switch", "an") ==
        "a rule of pc writes `an` to `k.lamp-2.switch`, which accepts \"on\" or \"off\"");
  CHECK_FALSE(told("k.lamp-2.switch", "On").empty()); // letter by letter
  CHECK(told("k.lamp-2.dim", "full").empty());
  CHECK(told("k.lamp-2.dim", "100").empty());
  CHECK(told("k.lamp-2.dim", "150") == "a rule of pc writes `150` to `k.lamp-2.dim`, which accepts "
                                       "\"full\", or numbers from 0 to 100 %");
  CHECK_FALSE(told("k.lamp-2.dim", "50 %").empty());
  CHECK(told("robot.goal", "at bed").empty());
  CHECK(told("robot.goal", "none").empty());
  CHECK(told("robot.goal", "go to bed") ==
        "a rule of pc writes `go to bed` to `robot.goal`, which has no such goal: there is at bed");
  CHECK(told("robot.goal", "at bad").ends_with("did you mean `at bed`?"));
  for (const auto* key : {"k.lamp-2.state", "robot.state", "robot.hand", "k.lamp-2.status"}) {
    CAPTURE(key);
    CHECK(told(key, "on").ends_with(
        "which only its owner publishes: values written by others have no effect"));
  }
}

TEST_CASE("what a rule waits for is what its tuple may tell", "[config]") {
  const auto told = [](const std::string& condition) {
    const auto found = warnings_of(flat(rule(condition)));
    return found.empty() ? std::string() : found.size() > 1 ? "several" : found[0];
  };
  for (const auto* good :
       {"when = 'k.lamp-2.state', equals = ['on']", "when = 'k.lamp-2.level', above = 100",
        "when = 'k.lamp-2.level', equals = ['dark', '7']",
        "when = 'k.lamp-2.temperature', above = 25", "when = 'k.lamp-2.temperature', above = 15",
        "when = 'k.lamp-2.temperature', equals = ['20.0']",
        "when = 'k.lamp-2.presence', equals = ['there']",
        "when = 'k.lamp-2.status', equals = ['active', 'lost']",
        "when = 'k.lamp-2.status.cause', equals = ['silence']",
        "when = 'k.lamp-2.temperature.freshness', equals = ['stale']",
        "when = 'k.lamp-2.switch.outcome', equals = ['on acknowledged']",
        "when = 'k.lamp-2.dim', above = 50", "when = 'k.lamp-2.room', equals = ['hall']",
        "when = 'robot.state', equals = ['driving', 'idle']",
        "when = 'robot.outcome', equals = ['at bed succeeded']",
        "when = 'robot.outcome.cause', equals = ['timeout']",
        "when = 'robot.hand', equals = ['empty', 'full']", "when = 'robot.lamp', equals = ['x']",
        "when = 'robot.goal', equals = ['at bed']"}) {
    CAPTURE(good);
    CHECK(told(good).empty());
  }
  CHECK(told("when = 'k.lamp-2.state', equals = ['on', 'an']") ==
        "a rule of pc waits until `k.lamp-2.state` is `an`, but its values are \"off\" or \"on\": "
        "did you mean `on`?");
  CHECK(told("when = 'k.lamp-2.state', above = 1") ==
        "a rule of pc compares `k.lamp-2.state` with 1, but its values are \"off\" or \"on\", "
        "which are not numbers");
  CHECK(told("when = 'k.lamp-2.presence', below = 1").ends_with("which are not numbers"));
  CHECK(told("when = 'k.lamp-2.temperature', above = 25.5") ==
        "a rule of pc waits until `k.lamp-2.temperature` is 25.5 or more, but its values are "
        "numbers from 15 to 25 C, as in 25.0");
  CHECK(told("when = 'k.lamp-2.level', above = 256").find("is 256 or more") != std::string::npos);
  for (const auto* bad :
       {"when = 'k.lamp-2.temperature', equals = ['20']",
        "when = 'k.lamp-2.temperature', equals = ['warm']",
        "when = 'k.lamp-2.temperature', equals = ['26.0']",
        "when = 'k.lamp-2.level', equals = ['0']", "when = 'k.lamp-2.level', equals = ['256']",
        "when = 'k.lamp-2.status', equals = ['alive']",
        "when = 'k.lamp-2.temperature.freshness', equals = ['old']",
        "when = 'k.lamp-2.switch.outcome', equals = ['on acknowleged']",
        "when = 'k.lamp-2.room', equals = ['kitchen']",
        "when = 'robot.state', equals = ['walking']", "when = 'robot.outcome', equals = ['at bed']",
        "when = 'robot.hand', equals = ['half']", "when = 'robot.goal', equals = ['at bath']"}) {
    CAPTURE(bad);
    CHECK_FALSE(told(bad).empty());
  }
}

TEST_CASE("a rule that never ends has a warning if it has something to write then", "[config]") {
  const auto ends = [](const std::string& otherwise) {
    return warnings_of(
        flat("{ when = 'k.lamp-2.temperature', above = 15, write = 'k.lamp-2.switch', "
             "then = 'on'" +
             otherwise + " }"));
  };
  CHECK(ends("").empty());
  REQUIRE(ends(", otherwise = 'off'").size() == 1);
  CHECK(ends(", otherwise = 'off'")[0].find("is below 15, but its values are") !=
        std::string::npos);
}

TEST_CASE("what is expected may come", "[config]") {
  CHECK(warnings_of(flat("", wanted("key = 'k.lamp-2.state', equals = ['on']"))).empty());
  CHECK(warning_of(flat("", wanted("key = 'k.lamp-2.state', equals = ['on', 'an']"))) ==
        "t.toml:1:69: an expectation waits until `k.lamp-2.state` is `an`, but its values are "
        "\"off\" or \"on\": did you mean `on`?");
  CHECK(warnings_of(flat("", wanted("key = 'k.lamp-2.temperature', above = 20, below = 21")))
            .empty());
  CHECK(warnings_of(flat("", wanted("key = 'k.lamp-2.temperature', above = 26"))).size() == 1);
  CHECK(warnings_of(flat("", wanted("key = 'k.lamp-2.temperature', below = 15"))).size() == 1);
  CHECK(warnings_of(flat("", wanted("key = 'k.lamp-2.state', equals = ['on'], when = { key = "
                                    "'k.lamp-2.switch', equals = ['an'] }")))
            .size() == 1);
}

TEST_CASE("a tuple that changes as the file says may tell anything", "[config]") {
  const auto warm = flat(rule("when = 'k.lamp-2.temperature', above = 30"));
  CHECK(warnings_of(warm).size() == 1);
  CHECK(warnings_of(warm + "[[change]]\nat = '1min'\nkind = 'proxy_class'\nclass = 'lamp'\n"
                           "field = 'temperature'\nscale = 1\n")
            .empty());
}

TEST_CASE("states wait for what the tuples of their inputs may tell", "[config]") {
  auto toml = flat("");
  const auto at = toml.find("sets = {");
  CHECK(warnings_of(std::string(toml).insert(at, "input = 'lamp', equals = ['on'], ")).empty());
  CHECK(warnings_of(std::string(toml).insert(at, "input = 'lamp', equals = ['lit'], ")) ==
        std::vector<std::string>{"a state of robot waits until `k.lamp-2.state` is `lit`, but its "
                                 "values are \"off\" or \"on\""});
  toml.replace(toml.find("pc:k.lamp-2.state"), 17, "pc:k.lamp-2.stat");
  CHECK(warnings_of(toml).at(0).starts_with(
      "an input of robot reads `k.lamp-2.stat`, a tuple that no component publishes"));
}

TEST_CASE("two proxies with one key have a warning, with both motes", "[config][PXY-15]") {
  auto toml = flat("");
  toml.insert(toml.find("[[proxy]]"), "[[island]]\nname = 'l'\nid = 2\nmote = [{ id = 2, type = "
                                      "'lamp', position_m = [1, 0] }]\n");
  CHECK(warnings_of(toml).empty());
  toml.insert(toml.find("properties ="), "prefix = '{name}'\n");
  toml.replace(toml.find("pc:k.lamp-2.state"), 17, "pc:lamp-2.state");
  CHECK(warning_of(toml) ==
        "t.toml:23:10: the proxies of k/lamp-2 and l/lamp-2 have the same key, "
        "`lamp-2`: a write to it reaches all of them, and its value may be from "
        "any of them; `prefix` can contain {island} and {name}");
}

TEST_CASE("a class whose motes have no manager has a warning", "[config][PXY-09]") {
  auto toml = flat("");
  toml.replace(toml.find("{ app = 'proxy_manager' }"), 25, "");
  toml.replace(toml.find(", from = 'pc:k.lamp-2.state'"), 28, "");
  CHECK(
      warning_of(toml) ==
      "t.toml:17:8: no proxy of [[proxy]] `lamp` is ever started: no peer has a \"proxy_manager\" "
      "for the island of k/lamp-2");
}

TEST_CASE("warnings of proxies and tuples have their places", "[config][GEN-06]") {
  const auto found = placed_warnings_of(home_with(
      "channel = 3\n[[proxy.input]]\nname = 'switch'\nchannel = 2\nwords = { on = '01' }\n",
      ", { app = 'collector', keys = ['x.y', 'k.c-2.temprature'] }"));
  REQUIRE(found.size() == 4);
  CHECK(to_string(found[0]).starts_with("t.toml:18:65: the collector of pc reads `x.y`"));
  CHECK(to_string(found[1]).starts_with("t.toml:18:72: the collector of pc reads `k.c-2.temp"));
  CHECK(to_string(found[2]).starts_with("t.toml:22:1: field `temperature`"));
  CHECK(to_string(found[3]).starts_with("t.toml:25:1: input `switch`"));
}

namespace {

/// An island with motes at these distances from its sink, under `[radio]`.
std::string row_of(const std::string& radio, const std::vector<int>& places_m,
                   const std::string& more = "") {
  auto toml =
      "[ecology]\nname = 't'\n[radio]\n" + radio + "\n[[island]]\nname = 'k'\nid = 1\n" + more;
  int id = 1;
  for (const auto x : places_m)
    toml += "[[island.mote]]\nid = " + std::to_string(++id) + "\ntype = 7\nposition_m = [" +
            std::to_string(x) + ", 0]\n";
  return toml;
}

} // namespace

TEST_CASE("a mote that nobody can hear has a warning", "[config][NET-15]") {
  const std::string law = "propagation = { model = 'log_distance', exponent = 3.3 }";
  CHECK(warning_of(row_of(law, {5, 600})) ==
        "t.toml:15:14: mote `mote-3` cannot join: of all radios with a route to the sink it is "
        "received best by `mote-2`, 595 m away, where its frames arrive with -132 dBm at most, and "
        "-95 are needed");
  CHECK(warnings_of(row_of(law, {40, 80, 120})).empty()); // over each other
  CHECK(warnings_of(row_of(law, {40, 120})).size() == 1);
  CHECK(warnings_of(row_of(law, {40, 120, 160})).size() == 2);
  // Drawn for each link: at best 3 deviations.
  CHECK(warnings_of(
            row_of("propagation = { model = 'log_distance', exponent = 3.3, shadowing = '4dB' }",
                   {70}))
            .empty());
  CHECK(warnings_of(row_of(law, {70})).size() == 1);
  CHECK(warnings_of(row_of("propagation = { model = 'friis' }", {150})).empty());
  CHECK(warnings_of(row_of("propagation = { model = 'friis' }", {5000})).size() == 1);
  CHECK(warnings_of(row_of("range = '30m'", {25, 50})).empty());
}

TEST_CASE("links that are given make up for distance, and take it", "[config][NET-15]") {
  const std::string law = "propagation = { model = 'log_distance', exponent = 3.3 }\n";
  const auto link = [](const std::string& from, const std::string& to, const std::string& what) {
    return "[[radio.link]]\nfrom = '" + from + "'\nto = '" + to + "'\n" + what + "\n";
  };
  const auto both = [&](const std::string& what) {
    return link("k/sink", "k/mote-2", what) + link("k/mote-2", "k/sink", what);
  };
  CHECK(warnings_of(row_of(law + both("gain = '-60dB'"), {600})).empty());
  CHECK(warnings_of(row_of(law + link("k/sink", "k/mote-2", "gain = '-60dB'"), {600})).size() == 1);
  CHECK(warnings_of(row_of(law + both("loss = 1"), {5})).size() == 1);
  CHECK(warnings_of(row_of(law + both("loss = 0.9"), {5})).empty());
}

TEST_CASE("a mote whose links in a topology are weak has a warning", "[config][NET-15]") {
  const auto found = [](const std::string& links) {
    const auto files = [&links](const std::string&, std::size_t) { return file_text{links, {}}; };
    return placed_warnings_of("[ecology]\nname = 't'\n[radio]\npropagation = { model = 'gains', "
                              "topology = 'l.txt' }\n[[island]]\nname = 'k'\nid = 1\nsink.id = 1\n"
                              "mote = [{ id = 2, type = 7 }, { id = 3, type = 7 }]\n",
                              files)
        .size();
  };
  CHECK(found("0 1 -60\n1 0 -60\n1 2 -60\n2 1 -60\n") == 0);
  CHECK(found("0 1 -60\n1 0 -60\n1 2 -60\n2 1 -96\n") == 1);
  CHECK(found("0 1 -60\n1 2 -60\n2 1 -60\n") == 2);
}

TEST_CASE("a mote whose walk comes near may join", "[config][NET-15]") {
  const std::string law = "propagation = { model = 'log_distance', exponent = 3.3 }";
  const auto walk = [&](const std::string& to) {
    return warnings_of(row_of(law, {5}) + "[[island.mote]]\nid = 3\ntype = 7\n" +
                       "path = [['0s', [600, 0]], ['10min', " + to + "]]\n");
  };
  CHECK(walk("[-600, 0]").empty()); // past the sink
  CHECK(walk("[600, 600]").size() == 1);
}

TEST_CASE("a walk that is faster than its step has a warning", "[config]") {
  const auto told = [](const std::string& path, const std::string& step = "") {
    return warning_of(row_of("range = '30m'", {}) +
                      "[[island.mote]]\nid = 2\ntype = 7\npath = " + path + "\n" + step);
  };
  CHECK(told("[['0s', [0, 0]], ['10s', [30, 0]]]").empty()); // 3 m/s
  CHECK(told("[['0s', [0, 0]], ['10s', [31, 0]]]") ==
        "t.toml:11:8: mote `mote-2` moves up to 3.1 m between two updates of its position, every 1 "
        "s, and the range of a radio is 30 m: a `step` of 960 ms would be a tenth of that");
  CHECK(told("[['0s', [0, 0]], ['10s', [31, 0]]]", "step = '900ms'\n").empty());
  CHECK(told("[['0s', [0, 0]], ['10s', [3, 0]]]", "step = '11s'\n")
            .starts_with("t.toml:12:8: mote `mote-2` moves up to 3.3 m"));
}

namespace {

/// What is said of a trace of an hour of a run.
std::string warning_of_trace(const std::string& text, const std::string& keys = "") {
  const auto files = [&text](const std::string&, std::size_t) { return file_text{text, {}}; };
  const auto found = placed_warnings_of(
      "[ecology]\nname = 't'\nduration = '1h'\n[[island]]\nname = 'k'\nid = 1\n[[island.mote]]\n"
      "id = 2\ntype = 7\nposition_m = [1, 2]\ntransducers.temperature = { model = 'trace', file = "
      "'t.csv'" +
          keys + " }\n",
      files);
  return found.empty() ? std::string() : found.size() > 1 ? "several" : to_string(found[0]);
}

const std::string hour = "time,temperature\n2016-03-01 00:00:00,20\n2016-03-01 00:20:00,22\n"
                         "2016-03-01 00:40:00,26\n2016-03-01 01:00:00,28\n";

} // namespace

TEST_CASE("a trace beside the run has a warning", "[config][STR-21]") {
  CHECK(warning_of_trace(hour).empty());
  CHECK(warning_of_trace(hour, ", start = '2026-03-01 00:00:00'") ==
        "t.toml:11:53: the trace \"t.csv\": none of its 4 readings is within the run: they are "
        "from 2016-03-01 00:00:00 to 2016-03-01 01:00:00, the run is from 2026-03-01 00:00:00 to "
        "2026-03-01 01:00:00; `start` sets the time of the trace at which that begins");
  CHECK(warning_of_trace(hour, ", start = '2016-02-01 00:00:00'").find("none of its 4 readings") !=
        std::string::npos);
  CHECK(warning_of_trace(hour + "2000-01-01 00:00:00,18.5\n")
            .find("only one of its 5 readings is within the run: they are from 2000-01-01") !=
        std::string::npos);
  CHECK(warning_of_trace("time,temperature\n0,20\n").empty()); // it is meant so
  CHECK(warning_of_trace("time,temperature\n7200,20\n").find("they are from 2 h to 2 h") !=
        std::string::npos);
  CHECK(warning_of_trace("time,temperature\n1456790400,20\n1456792200,22\n").empty());
}

TEST_CASE("a trace of a small part of the run has a warning", "[config][STR-21]") {
  const std::string minutes = "time,temperature\n0,20\n300,22\n600,23\n";
  CHECK(warning_of_trace(minutes).find("cover 15 min of a run of 1 h: the last one, of 10 min, "
                                       "applies until the end; `repeat = true` begins again") !=
        std::string::npos);
  CHECK(warning_of_trace(minutes, ", repeat = true").empty());
  CHECK(warning_of_trace("time,temperature\n0,20\n900,22\n1800,23\n").empty());
  CHECK(warning_of_trace("time,temperature\n2400,20\n3000,22\n4000,22\n")
            .find("cover 20 min of a run of 1 h: the first one, of 40 min, applies before") !=
        std::string::npos);
}

TEST_CASE("a trace with more lines skipped than read has a warning", "[config][STR-21]") {
  const std::string text = "time,temperature\n0,20\n1800,21\n2000,NA\n2001,\n";
  CHECK(warning_of_trace(text).empty());
  CHECK(warning_of_trace(text + "2002,\n").find("of its lines 3 are skipped") != std::string::npos);
}
