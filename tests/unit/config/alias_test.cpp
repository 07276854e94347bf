// Islands with several gateways.
#include <string>

#include "config/run/summary.hpp"
#include "support/catch.hpp"
#include "unit/config/sample.hpp"

using namespace rubicon;
using namespace rubicon::config;
using namespace rubicon::test;

namespace {

/// After island_head, from line 15 on.
std::string island_with(const std::string& rest) {
  return std::string(island_head) + rest;
}

} // namespace

TEST_CASE("an island may have further gateways, each with a cable of its own", "[config][GW-14]") {
  const auto x = good(island_with("[[island.alias]]\nid = 21\nserial.baud = 19200\n"
                                  "[[island.alias]]\nid = 22\nname = \"attic\"\n"
                                  "links = [\"inproc://pc\"]\n"
                                  "[[island]]\nname = \"old\"\nid = 2\n"));
  const auto& island = x.islands.at(0);
  REQUIRE(island.aliases.size() == 2);
  CHECK(island.aliases[0].id == peer_id{21});
  CHECK(island.aliases[0].name == "k-gateway-2");
  CHECK(island.aliases[0].serial.baud == 19200);
  CHECK(island.aliases[1].name == "attic");
  CHECK(island.aliases[1].links == std::vector<std::string>{"pc"});
  CHECK(island.aliases[1].serial.baud == island.serial.baud);
  CHECK(gateways_of(island) == std::vector{peer_id{1}, peer_id{21}, peer_id{22}});
  CHECK(gateways_of(x.islands.at(1)) == std::vector{peer_id{2}});
  const auto text = summary(x);
  CHECK(text.find("57600 baud, 3 gateways") != std::string::npos);
  CHECK(text.find("alias gateway of k") != std::string::npos);
}

TEST_CASE("aliases are peers for links, faults and references", "[config][GW-14]") {
  const auto x =
      good(island_with("[[island.alias]]\nid = 21\n"
                       "[[peer]]\nname = \"robot\"\nid = 30\n"
                       "links = [\"inproc://k-gateway-2\"]\n"
                       "[[fault]]\nkind = \"kill\"\npeer = \"k-gateway-2\"\nat = \"1s\"\n"
                       "[[fault]]\nkind = \"unplug\"\ngateway = \"k-gateway-2\"\nat = \"2s\"\n"
                       "[[fault]]\nkind = \"unplug\"\nisland = \"k\"\nat = \"3s\"\n"));
  CHECK(x.peers.at(0).links == std::vector<std::string>{"k-gateway-2"});
  CHECK(std::get<kill_fault>(x.faults.at(0).what).peer == peer_id{21});
  const auto& one = std::get<unplug_fault>(x.faults.at(1).what);
  CHECK(one.island == island_id{1});
  CHECK(one.gateway == peer_id{21});
  CHECK(!std::get<unplug_fault>(x.faults.at(2).what).gateway);
  CHECK(summary(x).find("k-gateway-2 for 30 s") != std::string::npos);
}

TEST_CASE("bad aliases are refused where they stand", "[config][GW-14]") {
  const row rows[] = {
      {"[[island.alias]]\nname = \"a\"\n", "15:1: `id` is missing in [[island.alias]]"},
      {"[[island.alias]]\nid = 255\n", "16:6: `id` must be a whole number from 1 to 254, not 255"},
      {"[[island.alias]]\nid = 1\n", "16:6: PEIS id 1 is already taken (line 13, column 6)"},
      {"[[island.alias]]\nid = 21\n[[island.alias]]\nid = 21\n",
       "18:6: PEIS id 21 is already taken (line 16, column 6)"},
      {"[[island.alias]]\nid = 21\nname = \"pc\"\n",
       "17:8: peer or gateway name `pc` is already taken (line 5, column 8)"},
      {"[[island.alias]]\nid = 21\n[[island.alias]]\nid = 22\n[[island.alias]]\nid = 23\n"
       "[[island.alias]]\nid = 24\n",
       "22:6: an island has at most 4 gateways"},
      {"gateway.apps = [{ app = \"recorder\" }]\n[[island.alias]]\nid = 21\n", nullptr},
      {"stack = \"mac\"\n[[island.alias]]\nid = 21\n",
       "16:1: `alias` has no effect in an island with stack = \"mac\""},
      {"[[fault]]\nkind = \"unplug\"\ngateway = \"pc\"\nat = \"1s\"\n",
       "17:11: that is not the name of a gateway"},
      {"[[fault]]\nkind = \"unplug\"\ngateway = \"k-gateway\"\nisland = \"k\"\nat = \"1s\"\n",
       "18:10: `island` has no effect with `gateway`"},
  };
  for (const auto& [toml, problem] : rows) {
    CAPTURE(toml);
    if (problem != nullptr)
      CHECK(problem_in(island_with(toml)) == problem);
    else
      CHECK(problem_in(island_with(toml))
                .find("a gateway has apps only where it is the island's only "
                      "one") != std::string::npos);
  }
}
