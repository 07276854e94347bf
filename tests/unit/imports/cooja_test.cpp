// Shapes of Cooja's files, valid and hostile.
#include "unit/imports/shapes.hpp"

namespace {

using namespace shapes;

std::string csc(const std::string& medium, const std::string& rest) {
  return "<simconf>\n<simulation>\n<title>hall</title>\n<randomseed>7</randomseed>\n<radiomedium>" +
         medium + "</radiomedium>\n" + rest + "</simulation>\n</simconf>\n";
}

std::string udgm(const std::string& settings = {}) {
  return "org.contikios.cooja.radiomediums.UDGM" + settings;
}

std::string graph(const std::string& edges) {
  return "org.contikios.cooja.radiomediums.DirectedGraphMedium" + edges;
}

std::string xml_mote(int id, double x, double y, const std::string& type = "t") {
  return "<mote><interface_config>org.contikios.cooja.interfaces.Position<x>" + std::to_string(x) +
         "</x><y>" + std::to_string(y) +
         "</y></interface_config><interface_config>org.contikios.cooja.mspmote.interfaces.MspMoteID"
         "<id>" +
         std::to_string(id) + "</id></interface_config><motetype_identifier>" + type +
         "</motetype_identifier></mote>\n";
}

std::string edge(const std::string& from, const std::string& dest) {
  return "<edge><source>" + from + "</source><dest>" + dest + "</dest></edge>";
}

} // namespace

TEST_CASE("motes of Cooja have places, a platform and the ranges of UDGM", "[imports]") {
  const auto x =
      taken(format::cooja,
            csc(udgm("<transmitting_range>42.5</transmitting_range>"
                     "<interference_range>80</interference_range>"),
                "<motetype>org.contikios.cooja.mspmote.SkyMoteType<identifier>s</identifier>"
                "</motetype>\n" +
                    xml_mote(1, 1.5, -2, "s") + xml_mote(4, 0, 0, "unknown")));
  CHECK(x.plan.title == "hall");
  CHECK(x.plan.seed == 7);
  CHECK(std::get<disk>(x.plan.air).range_m == 42.5);
  REQUIRE(x.plan.motes.size() == 2);
  CHECK(x.plan.motes[0].place == point{1.5, -2, 0});
  CHECK(x.plan.motes[0].platform == "telosb");
  CHECK(x.plan.motes[1].platform.empty());
  CHECK(noted(x, "firmware of mote type \"SkyMoteType\"") == text_place{6, 2});
  CHECK(noted(x, "interference_range").line == 5);
}

TEST_CASE("motes of Cooja may stand in their type, with positions as attributes", "[imports]") {
  const auto x = taken(
      format::cooja,
      csc(udgm(), "<motetype>org.contikios.cooja.contikimote.ContikiMoteType\n"
                  "<identifier>m</identifier>\n<mote><interface_config>"
                  "org.contikios.cooja.interfaces.Position<pos x=\"3.5\" y=\"4\" z=\"1\"/>"
                  "</interface_config><interface_config>org.contikios.cooja.contikimote.interfaces."
                  "ContikiMoteID<id>9</id></interface_config></mote>\n</motetype>\n"));
  REQUIRE(x.plan.motes.size() == 1);
  CHECK(x.plan.motes[0].number == 9);
  CHECK(x.plan.motes[0].place == point{3.5, 4, 1});
}

TEST_CASE("a seed that Cooja draws, plugins and unknown elements are not taken", "[imports]") {
  const auto x = taken(format::cooja, "<simconf><simulation><randomseed>generated</randomseed>"
                                      "<motedelay_us>1000000</motedelay_us><radiomedium>" +
                                          udgm() + "</radiomedium>" + xml_mote(1, 0, 0) +
                                          "</simulation>\n<plugin>org.contikios.cooja.plugins."
                                          "ScriptRunner</plugin></simconf>");
  CHECK_FALSE(x.plan.seed);
  CHECK(noted(x, "a seed drawn for each run").line == 1);
  CHECK(noted(x, "element \"motedelay_us\"").line == 1);
  CHECK(noted(x, "plugin \"ScriptRunner\"") == text_place{3, 2});
}

TEST_CASE("edges of a directed graph of Cooja are links", "[imports]") {
  const auto x = taken(
      format::cooja,
      csc(graph(edge("1", "<radio>2</radio><ratio>0.75</ratio><signal>-40</signal><lqi>100</lqi>") +
                edge("2", "<radio>1</radio><delay>5</delay>") +
                edge("2", "<radio>3</radio><ratio>0</ratio>")),
          xml_mote(1, 0, 0) + xml_mote(2, 5, 5) + xml_mote(3, 9, 9)));
  CHECK(std::holds_alternative<listed_links>(x.plan.air));
  REQUIRE(x.plan.links.size() == 2);
  CHECK(x.plan.links[0].loss == 0.25);
  CHECK(x.plan.links[0].gain_db == -40);
  CHECK(x.plan.links[1].loss == 0);
  CHECK(noted(x, "lqi of edges").line == 5);
  CHECK(noted(x, "delays of edges").line == 5);
}

TEST_CASE("with a ratio of UDGM below 1 a link loses more the longer it is", "[imports]") {
  const auto x =
      taken(format::cooja, csc(udgm("<transmitting_range>10</transmitting_range>"
                                    "<success_ratio_rx>0.5</success_ratio_rx>"),
                               xml_mote(1, 0, 0) + xml_mote(2, 10, 0) + xml_mote(3, 15, 0)));
  REQUIRE(x.plan.links.size() == 4); // 1 and 3 are too far apart
  CHECK(x.plan.links[0].loss == Approx(0.5));
  CHECK(x.plan.links[2].loss == Approx(0.125));
}

TEST_CASE("a medium of Cooja that is not known is a disk, which is noted", "[imports]") {
  const auto x = taken(format::cooja, csc("org.contikios.mrm.MRM", xml_mote(1, 0, 0)));
  CHECK(std::get<disk>(x.plan.air).range_m == 50);
  CHECK(noted(x, "radio medium \"MRM\": a disk of 50 m instead") == text_place{5, 2});
}

TEST_CASE("motes of Cooja whose names and texts are meant to do harm are taken as texts",
          "[imports]") {
  const auto x =
      taken(format::cooja, "<simconf><simulation><title>\"\n[radio]\nrange = 1\x1b[2J</title>"
                           "<radiomedium><![CDATA[x.UDGM]]></radiomedium><!-- <mote> -->" +
                               xml_mote(1, 0, 0) + "</simulation></simconf>");
  const auto toml = toml_of(x, format::cooja, "a\nb\x1b", "");
  CHECK(toml.find("\x1b") == std::string::npos);
  CHECK(toml.find("name = \"---radio--range---1--2J\"") != std::string::npos);
}

TEST_CASE("a file of Cooja is refused where it contradicts itself", "[imports]") {
  CHECK(refused(format::cooja, csc(udgm(), xml_mote(1, 0, 0) + xml_mote(1, 2, 2))) ==
        "7:2: there are two motes with the id 1");
  CHECK(refused(format::cooja, csc(graph(edge("1", "<radio>2</radio>")), xml_mote(1, 0, 0))) ==
        "5:103: there is no mote with the id 2");
  CHECK(refused(format::cooja, csc(graph(edge("1", "<radio>1</radio>")), xml_mote(1, 0, 0)))
            .find("the edge leads to its own source") != std::string::npos);
  CHECK(refused(format::cooja, csc(graph(edge("1", "<radio>all</radio>")), xml_mote(1, 0, 0)))
            .find("an edge to all radios is not supported") != std::string::npos);
  CHECK(refused(format::cooja, csc(udgm(), "")).find("there is no mote in it") !=
        std::string::npos);
}

TEST_CASE("a mote of Cooja needs a place and an id", "[imports]") {
  const std::string id = "<mote><interface_config>a.MoteID<id>3</id></interface_config></mote>\n";
  const std::string place = "<mote><interface_config>a.Position<x>1</x><y>1</y>"
                            "</interface_config></mote>\n";
  const std::string half = "<mote><interface_config>a.Position<x>1</x></interface_config></mote>\n";
  CHECK(refused(format::cooja, csc(udgm(), id)) ==
        "6:2: the mote has no interface with a position");
  CHECK(refused(format::cooja, csc(udgm(), place)) ==
        "6:2: the mote has no interface with an `id`");
  CHECK(refused(format::cooja, csc(udgm(), half)) == "6:8: the position has no y");
}

TEST_CASE("XML that is no simulation, or broken, is refused", "[imports]") {
  CHECK(refused(format::cooja, "").substr(0, 4) == "1:1:");
  CHECK(refused(format::cooja, "<html></html>") == "1:1: there is no element `simconf`");
  CHECK(refused(format::cooja, "<simconf>\n<project>").substr(0, 2) == "2:");
  CHECK_FALSE(refused(format::cooja, repeated("<a>", 100'000)).empty());
  CHECK_FALSE(refused(format::cooja, "<simconf><simulation>" + repeated("<a>", 50'000) +
                                         repeated("</a>", 50'000) + "</simulation></simconf>")
                  .empty());
  CHECK_FALSE(refused(format::cooja, std::string("<sim\0conf>", 10)).empty());
}

TEST_CASE("numbers in a file of Cooja have limits", "[imports]") {
  for (const auto* x : {"nan", "inf", "1e999", "100001", "-100001", "+-5", "1,5", "0x10"}) {
    INFO(x);
    const auto text = "<mote><interface_config>a.Position<x>" + std::string(x) +
                      "</x><y>1</y></interface_config></mote>\n";
    CHECK(refused(format::cooja, csc(udgm(), text)).find("x must be a number from -100000") !=
          std::string::npos);
  }
  CHECK(refused(format::cooja, csc(udgm(), xml_mote(65'001, 0, 0)))
            .find("a node must be a number from 0 to 65000") != std::string::npos);
  CHECK(refused(format::cooja, "<simconf><simulation><randomseed>9223372036854775808</randomseed>"
                               "</simulation></simconf>")
            .find("the seed must be a whole number") != std::string::npos);
  CHECK(refused(format::cooja,
                csc(udgm("<transmitting_range>0</transmitting_range>"), xml_mote(1, 0, 0)))
            .find("transmitting_range must be 0.1 m or more") != std::string::npos);
  taken(format::cooja, csc(udgm(), xml_mote(65'000, 100'000, -100'000)));
}
