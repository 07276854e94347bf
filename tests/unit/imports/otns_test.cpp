// Shapes of files of OTNS, valid and hostile.
#include "unit/imports/shapes.hpp"

namespace {

using namespace shapes;

} // namespace

TEST_CASE("a file of OTNS needs nodes only", "[imports]") {
  const auto x = taken(format::otns, "nodes:\n  - id: 1\n    pos: [1, 2]\n");
  REQUIRE(x.plan.motes.size() == 1);
  CHECK(x.plan.motes[0].place == point{1, 2, 0});
  CHECK(std::get<disk>(x.plan.air).range_m == 220);
}

TEST_CASE("a network of OTNS shifts nodes and their numbers", "[imports]") {
  const auto x = taken(format::otns, "network:\n  pos-shift: [100, -50, 2]\n  radio-range: 80\n"
                                     "  base-id: 10\nnodes:\n  - {id: 2, pos: [1, 2, 3]}\n"
                                     "  - {id: 1, pos: [0, 0, 0]}\n");
  CHECK(std::get<disk>(x.plan.air).range_m == 80);
  REQUIRE(x.plan.motes.size() == 2);
  CHECK(x.plan.motes[0].number == 11);
  CHECK(x.plan.motes[1].place == point{101, -48, 5});
}

TEST_CASE("types of nodes and other keys of OTNS are not taken", "[imports]") {
  const auto x = taken(format::otns, "script: x\nnodes:\n  - id: 1\n    type: router\n"
                                     "    pos: [0, 0]\n");
  CHECK(noted(x, "\"script\"") == text_place{1, 1});
  CHECK(noted(x, "\"type\" of nodes") == text_place{4, 5});
}

TEST_CASE("nodes of OTNS may be in one line, in quotes, and in any order of keys", "[imports]") {
  const auto x = taken(format::otns,
                       "{\"nodes\": [{\"pos\": [1.5, 2], \"id\": 7}, {'id': '3', pos: [4, 5]}]}");
  REQUIRE(x.plan.motes.size() == 2);
  CHECK(x.plan.motes[0].number == 3);
  CHECK(x.plan.motes[1].place == point{1.5, 2, 0});
}

TEST_CASE("a node 0 of OTNS shifts all ids by one", "[imports]") {
  const auto x =
      taken(format::otns, "nodes:\n- {id: 0, pos: [0, 0]}\n- {id: 65000, pos: [1, 1]}\n");
  const auto toml = toml_of(x, format::otns, "a.yaml", "");
  CHECK(toml.find("[island.sink]\nid = 1\n") != std::string::npos);
  CHECK(toml.find("id = 65001\nname = \"node-65000\"") != std::string::npos);
}

TEST_CASE("anchors, comments and several documents of OTNS do no harm", "[imports]") {
  const auto x = taken(format::otns, "# made by hand\nhere: &here [5, 6]\nnodes:\n"
                                     "  - id: 1 # the first\n    pos: *here\n");
  CHECK(x.plan.motes.at(0).place == point{5, 6, 0});
  CHECK(noted(x, "\"here\"").line == 2);
  std::string bomb = "a0: &a0 [x, x]\n";
  for (int i = 1; i < 30; ++i)
    bomb += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [*a" + std::to_string(i - 1) +
            ", *a" + std::to_string(i - 1) + "]\n";
  CHECK(taken(format::otns, bomb + "nodes:\n- {id: 1, pos: [0, 0]}\n").plan.motes.size() == 1);
  CHECK(refused(format::otns, bomb + "nodes: *a29\n").find("a node needs `id` and `pos`") !=
        std::string::npos);
}

TEST_CASE("nodes of OTNS without place, or twice the same, are refused", "[imports]") {
  CHECK(refused(format::otns, "nodes:\n- id: 1\n") == "2:3: a node needs `id` and `pos`");
  CHECK(refused(format::otns, "nodes:\n- {id: 1, pos: [0, 0]}\n- {id: 1, pos: [1, 1]}\n") ==
        "3:8: there are two nodes with the id 1");
  CHECK(refused(format::otns, "nodes:\n- {id: 1, pos: [0]}\n") ==
        "2:16: a position must be two or three numbers");
  CHECK(refused(format::otns, "nodes:\n- {id: 1, pos: [0, [1]]}\n") ==
        "2:20: y must be a single value");
  CHECK(refused(format::otns, "nodes: [5]\n") == "1:9: a node needs `id` and `pos`");
}

TEST_CASE("YAML that is no network of OTNS is refused", "[imports]") {
  for (const auto* x : {"", "nodes: 5\n", "[1, 2]", "just words", "nodes: {}\n", "~"})
    CHECK(refused(format::otns, x) == "1:1: there is no list `nodes`");
  CHECK(refused(format::otns, "nodes: []\n") == "0:0: there is no mote in it");
}

TEST_CASE("broken YAML of OTNS is refused where it breaks", "[imports]") {
  CHECK(refused(format::otns, "nodes:\n- {id: 1, pos: [0, 0]\n").substr(0, 2) == "3:");
  CHECK_FALSE(refused(format::otns, "nodes:\n\t- id: 1\n").empty());
  CHECK_FALSE(refused(format::otns, "nodes: *nobody\n").empty());
  CHECK_FALSE(refused(format::otns, "nodes: " + std::string(100'000, '[')).empty());
}

TEST_CASE("numbers of OTNS have limits", "[imports]") {
  CHECK(refused(format::otns, "nodes:\n- {id: 65001, pos: [0, 0]}\n") ==
        "2:8: a node must be a number from 0 to 65000, not \"65001\"");
  CHECK(refused(format::otns, "network: {base-id: 65000}\nnodes:\n- {id: 1, pos: [0, 0]}\n") ==
        "3:8: `base-id` and `id` must be at most 65000 together, not 65001");
  CHECK(refused(format::otns, "nodes:\n- {id: 1, pos: [.inf, 0]}\n").substr(0, 4) == "2:17");
  CHECK(refused(format::otns, "network: {radio-range: 0.5}\nnodes:\n- {id: 1, pos: [0, 0]}\n")
            .find("radio-range must be a number from 1 to 100000") != std::string::npos);
  CHECK(
      refused(format::otns, "network: {pos-shift: [99999, 0]}\nnodes:\n- {id: 1, pos: [2, 0]}\n") ==
      "3:16: with `pos-shift` it is more than 100000 m away from the origin");
  taken(format::otns, "network: {radio-range: 100000, base-id: 1, pos-shift: [1e5, 0]}\nnodes:\n"
                      "- {id: 64999, pos: [0, -1e5]}\n");
}
