// Shapes of TOSSIM's gains and noise floors, valid and hostile.
#include "unit/imports/shapes.hpp"

namespace {

using namespace shapes;

} // namespace

TEST_CASE("an ecology of TOSSIM's gains refers to them", "[imports]") {
  const auto x = taken(format::tossim, "gain 1 2 -60.5\ngain 2 1 -61\n");
  REQUIRE(x.plan.motes.size() == 2);
  CHECK(std::get<topology_file>(x.plan.air).first_node == 1);
  CHECK(x.notes.empty());
  const auto toml = toml_of(x, format::tossim, "gains", "a \"b\"\\c");
  CHECK(toml.find("topology = \"a \\\"b\\\"\\\\c\"") != std::string::npos);
  CHECK(toml.find("first_mote = 0\n") != std::string::npos);
  CHECK(toml.find("position_m") == std::string::npos);
}

TEST_CASE("a node 0 of TOSSIM's gains is mote 1", "[imports]") {
  const auto x = taken(format::tossim, "gain 0 1 -60\ngain 1 0 -60\n");
  CHECK(toml_of(x, format::tossim, "gains", "gains").find("first_mote = 1\n") != std::string::npos);
}

TEST_CASE("noise floors of TOSSIM are taken without their deviations", "[imports]") {
  const auto x = taken(format::tossim, "gain 1 2 -60\nnoise 1 -105 4\nnoise 2 -104.5 0\n");
  CHECK(std::get<topology_file>(x.plan.air).has_noise);
  CHECK(noted(x, "deviations of `noise` lines") == text_place{});
}

TEST_CASE("gains of TOSSIM may lack the word, and be separated by commas", "[imports]") {
  CHECK(taken(format::tossim, "0 1 -60.0\n1,0,-60.0\n").plan.motes.size() == 2);
  CHECK(taken(format::tossim, "GAIN\t3\t4\t-60 # near\r\n\r\n// nothing\r\n").plan.motes.size() ==
        2);
}

TEST_CASE("a node of TOSSIM with noise alone is no mote, and noise of some is not taken",
          "[imports]") {
  const auto x = taken(format::tossim, "gain 1 2 -60\nnoise 9 -100 1\nnoise 1 -100 1\n");
  CHECK(x.plan.motes.size() == 2);
  CHECK_FALSE(std::get<topology_file>(x.plan.air).has_noise);
  CHECK(noted(x, "`noise` of nodes that have no `gain`") == text_place{});
  CHECK(noted(x, "`noise` lines, as some nodes have none") == text_place{});
}

TEST_CASE("gains of TOSSIM in one direction only, and of far numbers, are taken", "[imports]") {
  const auto x = taken(format::tossim, "gain 64000 3 -90\n");
  REQUIRE(x.plan.motes.size() == 2);
  CHECK(x.plan.motes[0].number == 3);
}

TEST_CASE("a link of TOSSIM that is given twice is refused at the second", "[imports]") {
  CHECK(refused(format::tossim, "gain 1 2 -60\n  gain 2 1 -60\n  gain 1 2 -61\n") ==
        "3:3: the gain from 1 to 2 is given in line 1 already");
  CHECK(refused(format::tossim, "gain 1 2 -60\nnoise 1 -100 1\nnoise 1 -100 1\n").substr(0, 4) ==
        "3:1:");
  CHECK(refused(format::tossim, "gain 1 1 -60\n") == "1:1: gain needs two nodes, not 1 twice");
}

TEST_CASE("lines of TOSSIM with a field too few, too many or of another kind are refused",
          "[imports]") {
  for (const auto* x : {"gain 1 2", "gain 1 2 -60 5", "gain 1 two -60", "gain 1 2 loud",
                        "noise 1 -100", "loss 1 2 -60", "gain 1 2 nan", "gain -1 2 -60"}) {
    INFO(x);
    CHECK(refused(format::tossim, x).substr(0, 4) == "1:1:");
  }
}

TEST_CASE("a file without any gain of TOSSIM is refused", "[imports]") {
  for (const auto* x : {"", "# nothing\n", "noise 1 -100 1\n", "\n\n\n"})
    CHECK(refused(format::tossim, x) == "0:0: there is no gain in it");
  CHECK_FALSE(refused(format::tossim, std::string("gain 1 2\0-60", 12)).empty());
}

TEST_CASE("numbers of TOSSIM have limits", "[imports]") {
  CHECK(refused(format::tossim, "gain 65535 2 -60").find("0 to 65534") != std::string::npos);
  CHECK(refused(format::tossim, "gain 1 2 50.5").find("-250 to 50 dB") != std::string::npos);
  CHECK(refused(format::tossim, "gain 1 2 -250.5").find("-250 to 50 dB") != std::string::npos);
  CHECK(refused(format::tossim, "gain 65001 2 -60").find("65001") != std::string::npos);
  taken(format::tossim, "gain 65000 2 50\ngain 2 65000 -250\n");
}
