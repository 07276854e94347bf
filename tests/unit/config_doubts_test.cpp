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

} // namespace

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
