// Shapes of lists of nodes of IoT-LAB, valid and hostile.
#include "unit/imports/shapes.hpp"

namespace {

using namespace shapes;

std::string node(const std::string& name, const std::string& x, const std::string& rest = {}) {
  return R"({"network_address": ")" + name + R"(", "x": )" + x + R"(, "y": "2", "z": "0.5")" +
         rest + "}";
}

} // namespace

TEST_CASE("nodes of IoT-LAB have the first part of their address as name", "[imports]") {
  const auto x = taken(format::iotlab,
                       R"({"items": [)" + node("m3-10.grenoble.iot-lab.info", R"("1.5")") + "]}");
  REQUIRE(x.plan.motes.size() == 1);
  CHECK(x.plan.motes[0].name == "m3-10");
  CHECK(x.plan.motes[0].number == 1);
  CHECK(x.plan.motes[0].place == point{1.5, 2, 0.5});
  CHECK(noted(x, "what radios receive there: a disk of 50 m instead") == text_place{});
}

TEST_CASE("a list of nodes of IoT-LAB may stand alone, with numbers as numbers", "[imports]") {
  const auto x =
      taken(format::iotlab, "[\n" + node("a8-1", "-3.25") + ",\n" + node("a8-2", "1e1") + "\n]\n");
  REQUIRE(x.plan.motes.size() == 2);
  CHECK(x.plan.motes[0].place.x_m == -3.25);
  CHECK(x.plan.motes[1].place.x_m == 10);
}

TEST_CASE("nodes of IoT-LAB with the radio of a TelosB are TelosB", "[imports]") {
  const auto x =
      taken(format::iotlab, "[" + node("wsn430-1", "1", R"(, "archi": "wsn430:cc2420")") + ", " +
                                node("m3-1", "2", R"(, "archi": "m3:at86rf231")") + "]");
  CHECK(x.plan.motes.at(0).platform == "telosb");
  CHECK(x.plan.motes.at(1).platform.empty());
  CHECK(noted(x, "radio of \"m3:at86rf231\"").line == 1);
}

TEST_CASE("nodes of IoT-LAB without a position, and movements, are not taken", "[imports]") {
  const auto x =
      taken(format::iotlab, "[" + node("m3-1", "1", R"(, "mobile": "1")") + ",\n" +
                                node("m3-2", R"(" ")") + ", " + node("m3-3", "null") + "]");
  CHECK(x.plan.motes.size() == 1);
  CHECK(noted(x, "movements of mobile nodes").line == 1);
  CHECK(noted(x, "nodes without a position").line == 2);
  CHECK(refused(format::iotlab, "[\n" + node("m3-3", "null") + "]") ==
        "2:1: no node has a position");
}

TEST_CASE("JSON of IoT-LAB in one long line, or indented with tabs, is the same", "[imports]") {
  std::string line = "[";
  std::string lines = "[\n";
  for (int i = 1; i <= 500; ++i) {
    const auto each = node("m3-" + std::to_string(i), std::to_string(i));
    line += (i > 1 ? "," : "") + each;
    lines += (i > 1 ? ",\n\t\t" : "\t\t") + each;
  }
  const auto x = taken(format::iotlab, line + "]");
  const auto y = taken(format::iotlab, lines + "\n]");
  REQUIRE(x.plan.motes.size() == 500);
  REQUIRE(y.plan.motes.size() == 500);
  CHECK(x.plan.motes[499].place == y.plan.motes[499].place);
}

TEST_CASE("names of nodes of IoT-LAB that are none of ours are made such", "[imports]") {
  const auto x =
      taken(format::iotlab, "[" + node("sink", "1") + ", " + node("a b", "2") + ", " +
                                node("a-b", "3") + ", " + node("a\\u00fcb", "4") + ", " +
                                node("a-b-2", "5") + ", " + node(std::string(100, 'x'), "6") +
                                ", " + node(std::string(100, 'x') + "y", "7") + "]");
  const auto toml = toml_of(x, format::iotlab, "a.json", "");
  CHECK(toml.find("name = \"a-b\"") != std::string::npos);
  CHECK(toml.find("name = \"a-b-3\"") != std::string::npos);
}

TEST_CASE("two nodes of IoT-LAB with one address are refused", "[imports]") {
  CHECK(refused(format::iotlab, "[" + node("m3-1.lille", "1") + ",\n" + node("m3-1.paris", "2") +
                                    "]") == "2:21: there are two nodes \"m3-1\"");
  CHECK(refused(format::iotlab, R"([{"x": 1}])") == "1:2: a node needs `network_address`");
  CHECK(refused(format::iotlab, R"([{"network_address": ["m3"]}])") ==
        "1:22: network_address must be a single value");
}

TEST_CASE("JSON without nodes of IoT-LAB is refused", "[imports]") {
  for (const auto* x : {"{}", "5", R"({"items": 5})", R"({"items": {}})", "null", "\"text\""})
    CHECK(refused(format::iotlab, x) == "1:1: there is no list of nodes, nor a list `items`");
  CHECK(refused(format::iotlab, "[]") == "0:0: there is no mote in it");
}

TEST_CASE("what is no JSON is refused where it breaks", "[imports]") {
  CHECK(refused(format::iotlab, "[\n{'network_address': 1}]") == "2:2: this is no JSON");
  CHECK(refused(format::iotlab, "[" + node("m3-1", "01") + "]").find("this is no JSON") !=
        std::string::npos);
  CHECK(refused(format::iotlab, "") == "1:1: this is no JSON");
  CHECK_FALSE(refused(format::iotlab, std::string(100'000, '[')).empty());
  CHECK_FALSE(refused(format::iotlab, std::string(50'000, '[') + std::string(50'000, ']')).empty());
  CHECK_FALSE(refused(format::iotlab, "[\"\xff\xfe\"]").empty());
}

TEST_CASE("numbers of IoT-LAB have limits", "[imports]") {
  for (const auto* x : {"100000.5", "-100001", R"("1e6")", R"("five")"}) {
    INFO(x);
    CHECK(refused(format::iotlab, "[" + node("m3-1", x) + "]")
              .find("x must be a number from -100000 to 100000") != std::string::npos);
  }
  CHECK(refused(format::iotlab, "[" + node("m3-1", "1e999") + "]") ==
        "1:1: a number in it is too large");
  taken(format::iotlab, "[" + node("m3-1", "100000") + "]");
}
