#include <string>
#include <variant>
#include <vector>

#include "support/catch.hpp"
#include "support/start.hpp"
#include "translate/pattern.hpp"
#include "translate/translator.hpp"

using namespace rubicon;
using namespace rubicon::translate;
using test::start;

namespace {

expression parsed(const char* text) {
  return std::get<expression>(expression::parse(text));
}

using lines = std::vector<std::string>;

lines texts_of(const translator::outputs& outputs) {
  lines out;
  for (const auto& x : outputs) {
    if (const auto* set = std::get_if<publish>(&x))
      out.push_back(set->key + " = " + set->text);
    else
      out.push_back("delete " + std::get<erase>(x).key);
  }
  return out;
}

} // namespace

TEST_CASE("a pattern returns what its stars stand for", "[translate][SVC-09][TUP-03]") {
  using stars = std::vector<std::string>;
  CHECK(match("kitchen.*.ad0", "Kitchen.mote-7.AD0") == stars{"mote-7"});
  CHECK(match("*.*", "a.b") == stars{"a", "b"});
  CHECK(match("a.b", "a.b") == stars{});
  CHECK(!match("a.*", "a"));
  CHECK(!match("a.*", "a.b.c"));
  CHECK(!match("a.*", "b.b"));
  CHECK(stars_in("*.a*.*") == 2);
}

TEST_CASE("a target is a key with the stars of its pattern", "[translate][SVC-09]") {
  struct row {
    const char* to;
    std::size_t stars;
    bool good;
  };
  const auto r = GENERATE(values<row>({{"kitchen.luminosity", 0, true},
                                       {"kitchen.{1}.light", 1, true},
                                       {"{2}-{1}", 2, true},
                                       {"{1}", 0, false},
                                       {"{2}", 1, false},
                                       {"{0}", 1, false},
                                       {"{a}", 1, false},
                                       {"a..b", 0, false},
                                       {".a", 0, false},
                                       {"a.", 0, false},
                                       {"", 0, false},
                                       {"a.*", 1, false},
                                       {"a.b.c.d.e.f.g", 0, true},
                                       {"a.b.c.d.e.f.g.h", 0, false}}));
  CAPTURE(r.to, r.stars);
  CHECK(is_target(r.to, r.stars) == r.good);
  CHECK(filled("{2}-{1}.x", {"a", "b"}) == "b-a.x");
}

TEST_CASE("raw counts become a tuple with a meaning and a unit", "[translate][SVC-09]") {
  translator aut({{"*.board-3.ad0", "{1}.luminosity", parsed("(x - 400) * 0.5"), 1, "lx", 0}});
  CHECK(aut.watched() == lines{"*.board-3.ad0"});
  CHECK(texts_of(aut.on_value("kitchen.board-3.ad0", "512", false, start)) ==
        lines{"kitchen.luminosity.unit = lx", "kitchen.luminosity = 56.0"});
  CHECK(texts_of(aut.on_value("kitchen.board-3.ad0", "400", false, start + 1s)) ==
        lines{"kitchen.luminosity = 0.0"});
  CHECK(texts_of(aut.on_value("hall.board-3.ad0", "402", false, start + 1s)) ==
        lines{"hall.luminosity.unit = lx", "hall.luminosity = 1.0"});
  CHECK(aut.on_value("kitchen.board-3.ad1", "402", false, start).empty());
  CHECK(aut.counters().translated == 3);
}

TEST_CASE("what is no number is dropped and counted", "[translate][SVC-09]") {
  translator aut({{"a", "b", parsed("1 / x"), 2, "", 0}});
  CHECK(aut.on_value("a", "warm", false, start).empty());
  CHECK(aut.on_value("a", "12 C", false, start).empty());
  CHECK(aut.on_value("a", "inf", false, start).empty());
  CHECK(aut.on_value("a", "0", false, start).empty());
  CHECK(aut.counters().bad_values == 4);
  CHECK(texts_of(aut.on_value("a", "4", false, start)) == lines{"b = 0.25"});
}

TEST_CASE("without an expression a text goes on as it is", "[translate][SVC-09]") {
  translator aut({{"door.state", "hall.door", {}, 2, "", 0}});
  CHECK(texts_of(aut.on_value("door.state", "open, wide", false, start)) ==
        lines{"hall.door = open, wide"});
  CHECK(aut.on_value("door.state", std::string(translator::text_max, 'a'), false, start).size() ==
        1);
  CHECK(
      aut.on_value("door.state", std::string(translator::text_max + 1, 'a'), false, start).empty());
  CHECK(aut.counters().long_values == 1);
}

TEST_CASE("a translation ends with its tuple", "[translate][SVC-09]") {
  translator aut({{"a", "b", {}, 2, "", 2}});
  CHECK(aut.on_gone("a", false).empty());
  CHECK(aut.on_value("a", "1", false, start).size() == 2);
  CHECK(texts_of(aut.on_gone("A", false)) == lines{"delete b"});
  CHECK(aut.on_gone("a", false).empty());
  CHECK(texts_of(aut.on_value("a", "2", false, start)) ==
        lines{"b = 2", "b.history = 0.000000,1\n0.000000,2\n"});
}

TEST_CASE("a history keeps the newest values", "[translate][SVC-09]") {
  translator aut({{"room.*", "", {}, 2, "", 2}});
  CHECK(texts_of(aut.on_value("room.light", "10", false, start + 1s)) ==
        lines{"room.light.history = 1.000000,10\n"});
  CHECK(texts_of(aut.on_value("room.light", "20", false, start + 2s)) ==
        lines{"room.light.history = 1.000000,10\n2.000000,20\n"});
  CHECK(texts_of(aut.on_value("room.light", "30", false, start + 3500ms)) ==
        lines{"room.light.history = 2.000000,20\n3.500000,30\n"});
  CHECK(texts_of(aut.on_value("room.door", "a \"b\", c\nd", false, start)) ==
        lines{"room.door.history = 0.000000,\"a \"\"b\"\", c d\"\n"});
  const auto cut = texts_of(aut.on_value("room.door", std::string(500, 'z'), false, start));
  CHECK(cut.at(0).find(std::string(translator::history_text_max, 'z') + "\n") != std::string::npos);
  CHECK(cut.at(0).find(std::string(translator::history_text_max + 1, 'z')) == std::string::npos);
}

TEST_CASE("no rule feeds itself or another", "[translate][SVC-09]") {
  translator aut({{"a.*", "a.sum", parsed("x + 1"), 0, "V", 3},
                  {"*.sum", "b.sum", {}, 2, "", 0},
                  {"*.sum.*", "{2}", {}, 2, "", 0}});
  CHECK(aut.on_value("a.x", "1", false, start).size() == 3);
  CHECK(aut.on_value("a.sum", "2", true, start).empty());
  CHECK(aut.on_value("A.Sum", "2", true, start).empty());
  CHECK(aut.counters().own_tuples == 2);
  CHECK(aut.on_value("a.sum.unit", "V", true, start).empty());
  CHECK(aut.on_value("a.sum.history", "0.000,2", true, start).empty());
  CHECK(aut.counters().own_tuples == 4);
  // The same key of somebody else is another tuple.
  CHECK(aut.on_value("c.sum", "2", true, start).size() == 1);
  CHECK(aut.on_value("c.sum.unit", "V", true, start).size() == 1);
  // So is ours, once its translation has ended.
  CHECK(aut.on_gone("a.x", false).size() == 1);
  CHECK_FALSE(aut.on_value("a.sum", "2", true, start).empty());
}

TEST_CASE("targets are bounded, and their keys too", "[translate][SVC-09]") {
  translator aut({{"*", "t.{1}", {}, 2, "", 0}});
  for (std::size_t i = 0; i < translator::targets_max; ++i)
    REQUIRE(aut.on_value("k" + std::to_string(i), "1", false, start).size() == 1);
  CHECK(aut.on_value("more", "1", false, start).empty());
  CHECK(aut.counters().refused == 1);
  CHECK(aut.on_value("k7", "2", false, start).size() == 1);
  CHECK(aut.targets() == translator::targets_max);

  translator wide({{"*.*.*.*.*.*.*", "", {}, 2, "", 1}, {"*", "{1}{1}", {}, 2, "", 0}});
  CHECK(wide.on_value("a.b.c.d.e.f.g", "1", false, start).empty()); // no part left for `history`
  CHECK(wide.on_value(std::string(64, 'a'), "1", false, start).empty());
  CHECK(wide.counters().bad_keys == 2);
  CHECK(wide.on_value(std::string(63, 'a'), "1", false, start).size() == 1);
}
