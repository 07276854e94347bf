#include <string>

#include "config/doubts.hpp"
#include "config/listing.hpp"
#include "config/tuple_keys.hpp"
#include "config_sample.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::config;
using namespace rubicon::test;

namespace {

/// An island `k` with a mote `c-2` of type 7 that sends a temperature on channel 1, its proxy with
/// the field `temperature`, and what a peer `pc` does beside managing proxies.
std::string home(const std::string& field, const std::string& app = "") {
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

std::vector<std::string> doubts_of(const std::string& toml) {
  return doubts(good(toml));
}

/// What is to be said of an island of `motes` around their sink, with what follows its name.
std::vector<problem> doubts_of_island(int motes, const std::string& island,
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
  return x.doubts;
}

} // namespace

TEST_CASE("a mote may be silent for three periods of the windows", "[config][DIS-06][NRG-01]") {
  const auto doubts = doubts_of_island(
      2, "keep_alive = '29s'\nduty_cycle = { period = '10s', window = '100ms' }\n");
  REQUIRE(doubts.size() == 1);
  CHECK(
      to_string(doubts[0]) ==
      "t.toml:12:14: `keep_alive` is 29 s, but motes whose radios sleep are heard once in a period "
      "of 10 s: they are gone after three of these, 30 s");
  const auto count = [](const std::string& island) { return doubts_of_island(2, island).size(); };
  CHECK(count("keep_alive = '30s'\nduty_cycle = { period = '10s', window = '100ms' }\n") == 0);
  CHECK(count("duty_cycle = { period = '10s', window = '100ms' }\n") == 1); // 10 s by default
  CHECK(count("duty_cycle = { period = '9s', window = '100ms' }\n") == 0);
  CHECK(count("keep_alive = '1s'\n") == 0); // nobody sleeps
}

TEST_CASE("windows have room for those who share them", "[config][NRG-01]") {
  const auto said = [](int motes, const std::string& window, const std::string& every = "30s") {
    const auto doubts = doubts_of_island(
        motes, "duty_cycle = { period = '2s', window = '" + window + "' }\n", every);
    return doubts.empty() ? std::string() : to_string(doubts.at(0));
  };
  CHECK(said(50, "100ms") ==
        "t.toml:12:40: a window of 100 ms has room for 15 beacons, but 51 motes share it within "
        "reach "
        "of each other: after a restart of the sink they are gone for long; 340 ms would do");
  CHECK(said(50, "340ms").empty());
  CHECK_FALSE(said(50, "330ms").empty());
  CHECK(said(14, "100ms").empty());
  CHECK_FALSE(said(15, "100ms").empty());
  CHECK(said(14, "100ms", "1s").find("in each of them come 28 messages") != std::string::npos);
  const auto crowd = said(300, "1s");
  CHECK(crowd.find("with a period of 3.94 s at least") != std::string::npos);
}

TEST_CASE("only those who hear each other share a window", "[config][NRG-01]") {
  std::string toml = "[ecology]\nname = 't'\n[radio]\nrange = '30m'\n[[island]]\nname = 'k'\n"
                     "id = 1\nduty_cycle = { period = '2s', window = '100ms' }\n";
  for (int i = 1; i <= 60; ++i) // a line, in which each hears one to either side
    toml += "[[island.mote]]\nid = " + std::to_string(i + 1) + "\ntype = 7\nposition_m = [" +
            std::to_string(25 * i) + ", 0]\n";
  CHECK(load_text(toml, "t.toml").doubts.empty());
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

TEST_CASE("a good file leaves nothing to doubt", "[config]") {
  CHECK(doubts_of(home("channel = 1\n",
                       ", { app = 'collector', keys = ['k.*.temperature', 'devices.*.type'] }"))
            .empty());
}

TEST_CASE("what reads or writes a tuple that nobody has cannot work", "[config]") {
  CHECK(doubts_of(home("channel = 1\n", ", { app = 'collector', keys = ['k.c-2.temprature'] }")) ==
        std::vector<std::string>{"the collector of pc reads `k.c-2.temprature`, a tuple that "
                                 "nobody has: did you mean `k.c-2.temperature`?"});
  const auto rule =
      doubts_of(home("channel = 1\n", ", { app = 'rules', rules = [{ when = 'k.c-2.temperature', "
                                      "above = 1, write = 'k.lamp.switch', then = 'on' }] }"));
  REQUIRE(rule.size() == 1);
  CHECK(rule[0].starts_with("a rule of pc writes `k.lamp.switch`, a tuple that nobody has"));
  CHECK(doubts_of(home("channel = 1\n", ", { app = 'translate', rules = [{ from = 'x.y', "
                                        "to = 'x.z' }] }, { app = 'collector', keys = ['x.z'] }"))
            .size() == 1);
}

TEST_CASE("a peer of another process may have any tuple", "[config]") {
  auto toml = home("channel = 1\n", ", { app = 'collector', keys = ['x.y'] }");
  CHECK(doubts_of(toml).size() == 1);
  toml.insert(toml.find("name = 't'"), "mode = 'wall'\n");
  toml.insert(toml.find("id = 30"), "tcp = true\n");
  CHECK(doubts_of(toml).empty());
}

TEST_CASE("a field needs a program that sends it, and enough octets", "[config]") {
  CHECK(doubts_of(home("channel = 3\n")) ==
        std::vector<std::string>{"field `temperature` of [[proxy]] `p`: no program of motes of "
                                 "type c sends on channel 3"});
  CHECK(doubts_of(home("channel = 1\noffset = 1\n")) ==
        std::vector<std::string>{"field `temperature` of [[proxy]] `p` ends at octet 3, but "
                                 "messages of motes of type c on channel 1 have 2"});
  const auto input = doubts_of(home("channel = 1\n[[proxy.input]]\nname = 'switch'\nchannel = 2\n"
                                    "words = { on = '01' }\n"));
  CHECK(input == std::vector<std::string>{"input `switch` of [[proxy]] `p`: no program of motes "
                                          "of type c listens on channel 2"});
}

TEST_CASE("a type that nobody claims is told of once", "[config]") {
  auto toml = home("channel = 1\n");
  toml.replace(toml.find("types = [7]"), 11, "types = [8]");
  toml.insert(toml.find("[[peer]]"), "[[island.mote]]\nid = 3\ntype = 'c'\nposition_m = [1, 2]\n");
  const auto found = doubts_of(toml);
  REQUIRE(found.size() == 1);
  CHECK(found[0] == "no [[proxy]] claims motes of type c (7), as k/c-2 is one");
}

TEST_CASE("the list has motes, peers and tuples", "[config]") {
  const auto text = listing(good(home("channel = 1\nunit = 'C'\n")));
  CHECK(text.find("  k/c-2   1/2  type 7 (c), proxy p\n") != std::string::npos);
  CHECK(text.find("  k-gateway  1   gateway of k\n") != std::string::npos);
  CHECK(text.find("k.c-2.temperature.unit") != std::string::npos);
  CHECK(text.find("devices.**") != std::string::npos);
}
