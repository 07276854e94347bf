// Shapes of topologies of RIOT's ZEP dispatcher, valid and hostile.
#include "unit/imports/shapes.hpp"

namespace {

using namespace shapes;

} // namespace

TEST_CASE("a weight of ZEP counts for both directions, two for one each", "[imports]") {
  const auto x = taken(format::zep, "A B 0.9\nB C 0.75 0.5\n");
  REQUIRE(x.plan.motes.size() == 3);
  CHECK(x.plan.motes[0].name == "A");
  REQUIRE(x.plan.links.size() == 4);
  CHECK(x.plan.links[0].loss == Approx(0.1));
  CHECK(x.plan.links[1].loss == Approx(0.1));
  CHECK(x.plan.links[2].loss == 0.25);
  CHECK(x.plan.links[3].loss == 0.5);
}

TEST_CASE("a weight of ZEP of 0 is no link", "[imports]") {
  const auto x = taken(format::zep, "A B 1 0\n");
  REQUIRE(x.plan.links.size() == 1);
  CHECK(x.plan.links[0].from == 0);
  CHECK(taken(format::zep, "A B 0\n").plan.links.empty());
}

TEST_CASE("comments, blanks and line ends of ZEP are left out", "[imports]") {
  const auto x = taken(format::zep, "# a line\n\n  A\t B  1 \r\n   # another\n\tB C 0.5");
  CHECK(x.plan.motes.size() == 3);
  CHECK(x.notes.empty());
}

TEST_CASE("nodes of ZEP may have numbers as names, which are names", "[imports]") {
  const auto x = taken(format::zep, "9 4 1\n4 0 1\n");
  REQUIRE(x.plan.motes.size() == 3);
  CHECK(x.plan.motes[0].name == "9");
  CHECK(x.plan.motes[0].number == 1);
  CHECK(taken(format::zep, "9 4 1\n4 0 1\n", "0").sink == 2);
  CHECK(refused(format::zep, "9 4 1\n4 0 1\n", "1").find("there is no mote \"1\"") !=
        std::string::npos);
}

TEST_CASE("names of ZEP that are meant to do harm stay names", "[imports]") {
  const auto x = taken(format::zep, "\x1b[31m ../../etc 1\n\"] [radio] 1\n\xff\xfe x 0.5\n"
                                    "sink Sink 1\n");
  const auto toml = toml_of(x, format::zep, "a", "");
  CHECK(toml.find("\x1b") == std::string::npos);
  CHECK(toml.find("..") == std::string::npos);
}

TEST_CASE("a chain of a thousand nodes of ZEP is taken", "[imports]") {
  std::string text;
  for (int i = 0; i < 999; ++i)
    text += "n" + std::to_string(i) + " n" + std::to_string(i + 1) + " 0.99\n";
  const auto x = taken(format::zep, text);
  CHECK(x.plan.motes.size() == 1000);
  CHECK(x.plan.links.size() == 1998);
}

TEST_CASE("a link of ZEP that is given twice is refused", "[imports]") {
  CHECK(refused(format::zep, "A B 1\nC D 1\nB A 1\n") == "3:3: the link is already listed");
  CHECK(refused(format::zep, "A B 0\nA B 1\n") == "2:3: the link is already listed");
  CHECK(refused(format::zep, "A A 1\n") == "1:3: a link leads from one node to another");
}

TEST_CASE("lines of ZEP with a field too few or too many are refused", "[imports]") {
  CHECK(refused(format::zep, "A B 1\nA C\n") == "2:4: a weight is missing");
  CHECK(refused(format::zep, " A\n") ==
        "1:2: expected two nodes and one or two weights from 0 to 1");
  CHECK(refused(format::zep, "A B 1 1 1\n").substr(0, 4) == "1:1:");
}

TEST_CASE("a topology of ZEP without links is refused", "[imports]") {
  for (const auto* x : {"", "#\n", "\n \n", "\xef\xbb\xbf"})
    CHECK(refused(format::zep, x) == "0:0: there is no mote in it");
  CHECK_FALSE(refused(format::zep, std::string("A\0B 1", 5)).empty());
}

TEST_CASE("weights of ZEP have limits", "[imports]") {
  for (const auto* x : {"1.001", "-0.1", "nan", "1e300", "0,5", "half"}) {
    INFO(x);
    CHECK(refused(format::zep, "A B " + std::string(x)).substr(0, 43) ==
          "1:5: a weight must be a number from 0 to 1,");
  }
  CHECK(refused(format::zep, "A B 1 2").substr(0, 4) == "1:7:");
  taken(format::zep, "A B 1 0\nB C 1e-9\n");
}
