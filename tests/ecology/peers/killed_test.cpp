// How soon all peers of a network know that one of them is gone.
#include <cstdint>
#include <string>

#include "ecology/ecology_files.hpp"
#include "support/catch.hpp"
#include "support/seeds.hpp"

using namespace rubicon;
using namespace rubicon::test;

namespace {

/// A network in which one peer is killed 70 s after the start, 5 s before the end.
config::ecology_description network_of(int peers, std::uint64_t victim) {
  return describe("[ecology]\nname = \"peers\"\nduration = \"75s\"\n"
                  "[[peer]]\nid = 1\nname = \"peer\"\ncount = " +
                  std::to_string(peers) +
                  "\n[[fault]]\nat = \"70s\"\nkind = \"kill\"\npeer = \"peer-" +
                  std::to_string(victim) + "\"\n");
}

} // namespace

TEST_CASE("all know within 5 s that a peer was killed", "[ecology][peis][RTE-07][NFR-06]") {
  for (const std::uint64_t peers : {20U, 49U, 60U, 100U, 150U}) {
    for (std::uint64_t seed = 1; seed <= seeds(3); ++seed) {
      CAPTURE(peers, seed);
      const auto x = run(network_of(static_cast<int>(peers), 3 + 5 * seed), seed);
      std::uint64_t alive = 0;
      std::uint64_t know = 0;
      for (const auto& peer : x.peers) {
        alive += peer.alive ? 1 : 0;
        know += peer.alive && peer.hosts_known == peers - 1 ? 1 : 0;
      }
      CHECK(alive == peers - 1);
      CHECK(know == alive);
    }
  }
}
