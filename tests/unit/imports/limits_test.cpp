// One beyond each limit that files of all formats share.
#include "unit/imports/shapes.hpp"

namespace {

using namespace shapes;

constexpr auto all_formats = {format::cooja,  format::setdest, format::otns, format::iotlab,
                              format::tossim, format::zep,     format::k7};

std::string cooja_motes(std::size_t count) {
  return repeated("<mote><interface_config>a.Position<x>0</x><y>0</y></interface_config>"
                  "<interface_config>a.MoteID<id>#</id></interface_config></mote>\n",
                  count, 1);
}

std::string cooja(const std::string& medium, std::size_t motes) {
  return "<simconf><simulation><radiomedium>" + medium + "</radiomedium>" + cooja_motes(motes) +
         "</simulation></simconf>";
}

/// `A B` of so many pairs of different numbers.
template <class Line>
std::string pairs(std::size_t count, Line line) {
  constexpr std::size_t in_a_row = 1000;
  std::string out;
  for (std::size_t i = 0; i < count; ++i)
    out += line(std::to_string(1 + i / in_a_row), std::to_string(2000 + i % in_a_row));
  return out;
}

bool is_refused(format from, const std::string& text, std::string_view why) {
  const auto found = refused(from, text);
  INFO(found);
  return found.find(why) != std::string::npos;
}

bool is_taken(format from, const std::string& text) {
  return refused(from, text).empty();
}

} // namespace

TEST_CASE("a file of any format has 64 MiB at most", "[imports]") {
  const std::string text(file_octets_max + 1, ' ');
  for (const auto each : all_formats)
    CHECK(refused(each, text) == "0:0: it has more than 64 MiB");
  CHECK(refused(format::zep, std::string_view(text).substr(1)) == "0:0: there is no mote in it");
}

TEST_CASE("a file of any format has 10000 motes at most", "[imports]") {
  const std::string medium = "org.contikios.cooja.radiomediums.DirectedGraphMedium";
  const auto file_of = [&](format from, std::size_t count) -> std::string {
    switch (from) {
    case format::cooja:
      return cooja(medium, count);
    case format::setdest:
      return repeated("$node_(#) set X_ 1\n", count);
    case format::otns:
      return "nodes:\n" + repeated("- {id: #, pos: [0, 0]}\n", count);
    case format::iotlab:
      return "[" + repeated(R"({"network_address": "m#", "x": 0, "y": 0, "z": 0},)", count - 1) +
             R"({"network_address": "last", "x": 0, "y": 0, "z": 0}])";
    case format::tossim:
      return repeated("gain 60000 # -60\n", count - 1);
    case format::zep:
      return repeated("A # 1\n", count - 1);
    case format::k7:
      return "{}\ndatetime,src,dst,pdr\n" + repeated("2018-01-11 16:32:15,a,#,1\n", count - 1);
    }
    return {};
  };
  for (const auto each : all_formats) {
    INFO(to_string(each));
    CHECK(is_taken(each, file_of(each, motes_max)));
    CHECK(is_refused(each, file_of(each, motes_max + 1), "there are more than 10000 motes"));
  }
}

TEST_CASE("an imported file has 200000 links at most", "[imports]") {
  const auto zep = [](std::size_t count) { // both directions
    return pairs(count, [](const auto& a, const auto& b) { return a + ' ' + b + " 1\n"; });
  };
  CHECK(is_taken(format::zep, zep(links_max / 2)));
  CHECK(is_refused(format::zep, zep(links_max / 2 + 1), "there are more than 200000 links"));

  const auto k7 = [](std::size_t count) {
    return "{}\ndatetime,src,dst,pdr\n" + pairs(count, [](const auto& a, const auto& b) {
             return "2018-01-11 16:32:15," + a + ',' + b + ",1\n";
           });
  };
  CHECK(is_taken(format::k7, k7(links_max)));
  CHECK(is_refused(format::k7, k7(links_max + 1), "there are more than 200000 links"));

  const auto edges = [](std::size_t count) {
    return cooja("a.DirectedGraphMedium" + pairs(count,
                                                 [](const auto& a, const auto& b) {
                                                   return "<edge><source>" + a +
                                                          "</source><dest><radio>" + b +
                                                          "</radio></dest></edge>\n";
                                                 }),
                 3000);
  };
  CHECK(is_taken(format::cooja, edges(links_max)));
  CHECK(is_refused(format::cooja, edges(links_max + 1), "there are more than 200000 links"));
  CHECK(is_refused(format::cooja, cooja("a.UDGM<success_ratio_rx>0.5</success_ratio_rx>", 1000),
                   "success_ratio_rx needs more than 200000 links"));
}

TEST_CASE("a K7 trace has two million rows at most, and 20000 changes are taken", "[imports]") {
  const std::string begin = "{}\ndatetime,src,dst,pdr\n";
  std::string rows = begin;
  for (std::size_t i = 0; i <= 2'000'000; ++i)
    rows += "2018-01-11 16:32:15,a,b,1\n";
  CHECK(refused(format::k7, rows) == "2000003:1: there are more than 2000000 rows");

  std::string changing = begin;
  const auto two = [](std::size_t i) { return (i < 10 ? "0" : "") + std::to_string(i); };
  for (std::size_t i = 0; i <= changes_max + 1; ++i)
    changing += "2018-01-" + two(1 + i / 1440) + ' ' + two(i / 60 % 24) + ':' + two(i % 60) +
                ":00,a,b," + (i % 2 == 0 ? "1" : "0.5") + '\n';
  const auto x = import_text(format::k7, changing);
  REQUIRE(std::holds_alternative<imported>(x));
  CHECK(std::get<imported>(x).plan.changes.size() == changes_max);
  CHECK(noted(std::get<imported>(x), "changes of links after the 20000th") == text_place{});
}

TEST_CASE("what is not taken is listed up to 200 kinds", "[imports]") {
  const auto with = [](std::size_t count) {
    return "<simconf><simulation><radiomedium>a.UDGM</radiomedium>" + cooja_motes(1) +
           "</simulation>" + repeated("<plugin>a.P#</plugin>", count) + "</simconf>";
  };
  const auto x = taken(format::cooja, with(200));
  CHECK(x.notes.size() == 200);
  const auto y = taken(format::cooja, with(201));
  CHECK(y.notes.size() == 201);
  CHECK(noted(y, "kinds of things beyond the 200 listed here") == text_place{});
}

TEST_CASE("places far behind in a file are right", "[imports]") {
  const std::string line(1000, 'x');
  std::string text = "<simconf><simulation>";
  for (int i = 0; i < 50; ++i)
    text += "<!-- " + line + " -->\n";
  const auto wrong = text + std::string(9000, ' ') + "<mote></mote></simulation></simconf>";
  CHECK(refused(format::cooja, wrong) == "51:9002: the mote has no interface with an `id`");
  for (std::size_t blanks = 0; blanks < 5000; blanks += 37) { // over the ends of blocks
    const auto shifted = "\n" + std::string(blanks, ' ') + "<simconf>\n<simulation>\n<mote/>";
    CHECK(refused(format::cooja, shifted + "</simulation></simconf>").substr(0, 4) == "4:2:");
  }
}
