// How soon all peers of a network know that one of them is gone.
#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "ecology/ecology_files.hpp"
#include "support/catch.hpp"
#include "support/seeds.hpp"

using namespace rubicon;
using namespace rubicon::test;

namespace {

constexpr auto peers_text = R"(
[ecology]
name = "peers"
duration = "75s"
)";

/// So many peers, of which these are killed 70 s after the start, 5 s before the end.
std::string network_of(std::uint64_t peers, const std::vector<std::uint64_t>& victims) {
  auto text = peers_text + std::string("[[peer]]\nid = 1\nname = \"peer\"\ncount = ") +
              std::to_string(peers) + '\n';
  for (const auto x : victims)
    text += "[[fault]]\nat = \"70s\"\nkind = \"kill\"\npeer = \"peer-" + std::to_string(x) + "\"\n";
  return text;
}

/// How many of those that live know `hosts` hosts.
std::uint64_t knowing(const report::run_report& x, std::uint64_t hosts) {
  return static_cast<std::uint64_t>(std::ranges::count_if(
      x.peers, [&](const auto& peer) { return peer.alive && peer.hosts_known == hosts; }));
}

} // namespace

TEST_CASE("all know within 5 s that a peer was killed", "[ecology][peis][RTE-07][NFR-06]") {
  for (const std::uint64_t peers : {20U, 49U, 60U, 100U, 150U}) {
    for (std::uint64_t seed = 1; seed <= seeds(3); ++seed) {
      CAPTURE(peers, seed);
      const auto x = run(describe(network_of(peers, {3 + 5 * seed})), seed);
      CHECK(knowing(x, peers - 1) == peers - 1);
    }
  }
}

TEST_CASE("all know within 5 s that two peers were killed at once", "[ecology][peis][RTE-07]") {
  for (std::uint64_t seed = 1; seed <= seeds(3); ++seed) {
    CAPTURE(seed);
    const auto x = run(describe(network_of(60, {3 + 5 * seed, 40 + seed})), seed);
    CHECK(knowing(x, 58) == 58);
  }
}

TEST_CASE("all know within 5 s that a peer is beyond one that was killed",
          "[ecology][peis][RTE-07]") {
  for (std::uint64_t seed = 1; seed <= seeds(3); ++seed) {
    CAPTURE(seed);
    const auto text = network_of(20, {2}) + "[[peer]]\nid = 100\nname = \"leaf\"\nleaf = true\n"
                                            "links = [\"inproc://peer-2\"]\n";
    const auto x = run(describe(text), seed);
    CHECK(knowing(x, 19) == 19); // neither of the two
  }
}
