// Peers in wall time whose link is one over UDP on loopback.
#include "ecology/ecology_files.hpp"
#include "report/report.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::test;

TEST_CASE("an ecology runs over UDP, and its report counts the datagrams",
          "[ecology][peis][UDP-01]") {
  const auto x = run(describe(R"(
[ecology]
name = "over-udp"
mode = "wall"
duration = "4s"

[[peer]]
id = 11
name = "robot"
discovery = false
manager = false
tcp = { port = 18460 }
udp = true

[[peer]]
id = 12
name = "pc"
manager = false
connect = ["udp://127.0.0.1:18460"]
udp = true
)"));
  for (const auto& each : x.violations)
    UNSCOPED_INFO(each.invariant << ": " << each.detail);
  CHECK(x.violations.empty());
  REQUIRE(x.peers.size() == 2);
  for (const auto& peer : x.peers) {
    CAPTURE(peer.name);
    CHECK(peer.links == 1);
    CHECK(peer.links_opened == 1);
    CHECK(peer.cluster == 11);
    const auto counted = [&](const std::string& name) {
      const auto found = peer.counters.find(name);
      return found == peer.counters.end() ? 0 : found->second;
    };
    CHECK(counted("udp.parts_sent") >= 3);
    CHECK(counted("udp.received") > 5);
    CHECK(counted("udp.malformed") + counted("udp.unknown") + counted("udp.impossible") == 0);
  }
}
