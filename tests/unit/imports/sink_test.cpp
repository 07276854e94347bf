// Which mote of an imported file is the sink.
#include "unit/imports/shapes.hpp"

namespace {

using namespace shapes;

constexpr std::string_view three_motes =
    "$node_(4) set X_ 1\n$ns_ at 1 \"$node_(4) setdest 9 1 1\"\n"
    "$node_(5) set X_ 2\n$node_(6) set X_ 3\n";

} // namespace

TEST_CASE("the sink is the first mote that stays, unless another one is named", "[imports]") {
  CHECK(taken(format::setdest, three_motes).sink == 1);
  CHECK(taken(format::setdest, three_motes, "6").sink == 2);
  const auto toml = toml_of(taken(format::setdest, three_motes, "6"), format::setdest, "a", "");
  CHECK(toml.find("[island.sink]\nid = 6\n") != std::string::npos);
  CHECK(toml.find("# The sink is node 6;") != std::string::npos);
  CHECK(toml.find("name = \"node-5\"") != std::string::npos);
}

TEST_CASE("a sink that moves in the file stays, which is noted", "[imports]") {
  const auto x = taken(format::setdest, three_motes, "4");
  CHECK(x.sink == 0);
  CHECK(notes_text(x, "a.tcl") ==
        "a.tcl: not taken: movements of the sink, which stays where it is at the beginning\n");
  CHECK(toml_of(x, format::setdest, "a", "").find("path") == std::string::npos);
}

TEST_CASE("a sink is named as in its file", "[imports]") {
  CHECK(taken(format::zep, "A B 1\nB C 1\n", "C").sink == 2);
  CHECK(taken(format::tossim, "gain 7 8 -60\n", "8").sink == 1);
  CHECK(taken(format::k7, "{}\ndatetime,src,dst,pdr\n2018-01-11 16:32:15,0,3,1\n", "3").sink == 1);
  CHECK(taken(format::otns, "nodes:\n- {id: 0, pos: [0, 0]}\n- {id: 2, pos: [1, 1]}\n", "2").sink ==
        1);
}

TEST_CASE("a sink that the file lacks is refused, with a name that is meant", "[imports]") {
  CHECK(refused(format::zep, "kitchen hall 1\n", "kichen") ==
        "0:0: there is no mote \"kichen\", which --sink names: did you mean `kitchen`?");
  CHECK(refused(format::setdest, three_motes, "7")
            .find("there is no mote \"7\", which --sink names") != std::string::npos);
  CHECK(refused(format::setdest, three_motes, "\x1b[2J").find("\x1b") == std::string::npos);
}
