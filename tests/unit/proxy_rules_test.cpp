#include <clocale>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "proxy/rules.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::proxy;

namespace {

using writes = std::vector<write_tuple>;

rule heat() {
  rule x;
  x.when = "kitchen.climate.temperature";
  x.above = 25.0;
  x.below = 22.0;
  x.writes = {{"kitchen.fan.switch", "on", "off"}};
  return x;
}

std::string word_at(rules& aut, std::string_view text) {
  const auto out = aut.on_value("kitchen.climate.temperature", text, instant{});
  return out.empty() ? "" : out.front().word;
}

} // namespace

TEST_CASE("a rule writes when a value crosses a threshold and not between them", "[proxy][rules]") {
  rules aut({heat()});
  const std::vector<std::pair<std::string, std::string>> steps{
      {"23", ""},      // unknown, between: nothing is known
      {"24.999", ""},  // still
      {"25", "on"},    // at `above`
      {"30", ""},      // already high
      {"22", ""},      // at `below` is not below
      {"21.9", "off"}, //
      {"-4", ""},      //
      {"24.9", ""},    //
      {"25.0", "on"},  //
      {"1e1", "off"},  //
      {"26", "on"}};
  for (const auto& [value, word] : steps) {
    CAPTURE(value);
    CHECK(word_at(aut, value) == word);
  }
  CHECK(aut.counters().values == steps.size());
  CHECK(aut.counters().writes == 5);
}

TEST_CASE("the first value beyond a threshold decides", "[proxy][rules]") {
  rules high({heat()});
  CHECK(word_at(high, "25") == "on");
  rules low({heat()});
  CHECK(word_at(low, "0") == "off");
}

TEST_CASE("a missing threshold is the other one, a missing word is not written", "[proxy][rules]") {
  auto one = heat();
  one.below.reset();
  rules above_only({one});
  CHECK(word_at(above_only, "24.9") == "off");
  CHECK(word_at(above_only, "25") == "on");
  CHECK(word_at(above_only, "24.9") == "off");
  one = heat();
  one.above.reset();
  rules below_only({one});
  CHECK(word_at(below_only, "22") == "on");
  CHECK(word_at(below_only, "21.9") == "off");
  one.below.reset();
  rules never({one});
  CHECK(word_at(never, "1000").empty());
  CHECK(word_at(never, "-1000").empty());
  one = heat();
  one.writes[0].otherwise.clear();
  rules then_only({one});
  CHECK(word_at(then_only, "25") == "on");
  CHECK(word_at(then_only, "0").empty());
  CHECK(word_at(then_only, "25") == "on");
}

TEST_CASE("a text that is not a finite number changes nothing", "[proxy][rules]") {
  rules aut({heat()});
  CHECK(word_at(aut, "0") == "off");
  const std::vector<std::string> bad{
      "",     " ",   "warm", "30 C", " 30",   "30 ",    "+30",  "30,5",
      "0x30", "inf", "-inf", "nan",  "1e999", "30.5.1", "--30", std::string("30\0", 3)};
  for (const auto& text : bad) {
    CAPTURE(text);
    CHECK(word_at(aut, text).empty());
  }
  CHECK(aut.counters().bad_values == bad.size());
  CHECK(word_at(aut, "30") == "on");
}

TEST_CASE("rules share keys, whatever their letter case", "[proxy][rules][TUP-03]") {
  auto alarm = heat();
  alarm.when = "Kitchen.Climate.Temperature";
  alarm.above = 60;
  alarm.below = 50;
  alarm.writes = {{"alarm.bell", "ring", {}}};
  auto second = heat();
  second.writes[0].key = "KITCHEN.fan.switch";
  second.when = "hall.temperature";
  rules aut({heat(), alarm, second});
  CHECK(aut.watched() == std::vector<std::string>{"kitchen.climate.temperature", "hall.temperature",
                                                  "kitchen.fan.switch.outcome",
                                                  "alarm.bell.outcome"});
  CHECK(aut.written() == std::vector<std::string>{"kitchen.fan.switch", "alarm.bell"});
  CHECK(aut.on_value("KITCHEN.climate.temperature", "70", instant{}) ==
        writes{{"kitchen.fan.switch", "on"}, {"alarm.bell", "ring"}});
  CHECK(aut.on_value("kitchen.humidity", "70", instant{}).empty());
  CHECK(aut.counters().unwatched == 1);
  CHECK(aut.on_value("hall.temperature", "0", instant{}) == writes{{"kitchen.fan.switch", "off"}});
}

TEST_CASE("a new owner is told the word that stands", "[proxy][rules]") {
  rules aut({heat()});
  CHECK(aut.on_owner("kitchen.fan.switch", instant{}).empty());
  CHECK(word_at(aut, "30") == "on");
  CHECK(aut.on_owner("Kitchen.Fan.switch", instant{}) == writes{{"kitchen.fan.switch", "on"}});
  CHECK(aut.on_owner("alarm.bell", instant{}).empty());
  CHECK(word_at(aut, "0") == "off");
  CHECK(aut.on_owner("kitchen.fan.switch", instant{}) == writes{{"kitchen.fan.switch", "off"}});

  auto one = heat();
  one.writes[0].otherwise.clear();
  rules silent({one});
  CHECK(word_at(silent, "30") == "on");
  CHECK(word_at(silent, "0").empty());
  CHECK(silent.on_owner("kitchen.fan.switch", instant{}).empty()); // `on` no longer stands
}

TEST_CASE("a condition must last before anything is written", "[proxy][rules]") {
  auto lasting = heat();
  lasting.lasting = 30s;
  lasting.otherwise_lasting = 10s;
  rules aut({lasting});
  const auto at = [&](duration since, std::string_view value) {
    return aut.on_value("kitchen.climate.temperature", value, instant(since));
  };
  CHECK(at(0s, "26").empty());
  CHECK(aut.deadline() == instant(30s));
  CHECK(at(20s, "30").empty()); // still: the delay goes on
  CHECK(aut.deadline() == instant(30s));
  CHECK(at(25s, "24").empty()); // between: begins anew
  CHECK(!aut.deadline());
  CHECK(at(40s, "26").empty());
  CHECK(aut.on_time(instant(69s)).empty());
  CHECK(aut.on_time(instant(70s)) == writes{{"kitchen.fan.switch", "on"}});
  CHECK(!aut.deadline());
  CHECK(at(80s, "20").empty());
  CHECK(aut.deadline() == instant(90s));
  CHECK(at(85s, "27").empty());
  CHECK(!aut.deadline());
  CHECK(at(86s, "20").empty());
  CHECK(aut.on_time(instant(96s)) == writes{{"kitchen.fan.switch", "off"}});
  CHECK(at(100s, "26").empty());
  aut.on_gone("kitchen.climate.temperature");
  CHECK(!aut.deadline());
  CHECK(at(130s, "26").empty());
  CHECK(at(160s, "26") == writes{{"kitchen.fan.switch", "on"}}); // the timer was late
}

TEST_CASE("a rule may ask for one of some texts, and write several tuples", "[proxy][rules]") {
  rule night;
  night.when = "bedroom.bed.presence";
  night.equals = {"yes", "asleep"};
  night.writes = {{"bedroom.lamp.switch", "off", "on"}, {"robot.mode", "quiet", {}}};
  rules aut({night});
  const auto at = [&](std::string_view value) {
    return aut.on_value("bedroom.bed.presence", value, instant{});
  };
  CHECK(at("no") == writes{{"bedroom.lamp.switch", "on"}});
  CHECK(at("yes") == writes{{"bedroom.lamp.switch", "off"}, {"robot.mode", "quiet"}});
  CHECK(at("asleep").empty());
  CHECK(at("Yes") == writes{{"bedroom.lamp.switch", "on"}});
  CHECK(aut.counters().bad_values == 0);
}

TEST_CASE("what has failed at its proxy is written again, later and later", "[proxy][rules]") {
  rules aut({heat()}, 5s);
  CHECK(aut.watched() ==
        std::vector<std::string>{"kitchen.climate.temperature", "kitchen.fan.switch.outcome"});
  const auto outcome = [&](std::string_view text, duration at) {
    CHECK(aut.on_value("Kitchen.fan.switch.outcome", text, instant(at)).empty());
  };
  outcome("on failed", 0s); // nothing stands
  CHECK(word_at(aut, "30") == "on");
  CHECK(!aut.deadline());
  const writes again{{"kitchen.fan.switch", "on", true}};
  duration at = 1s;
  for (const auto pause : {5s, 10s, 20s, 40s, 60s, 60s}) {
    outcome("on unreachable", at);
    CHECK(aut.deadline() == instant(at + pause));
    CHECK(aut.on_time(instant(at + pause - 1ns)).empty());
    CHECK(aut.on_time(instant(at + pause)) == again);
    CHECK(!aut.deadline());
    at += pause + 1s;
  }
  CHECK(aut.counters().repeats == 6);
  for (const auto* text : {"off failed", "on refused", "on superseded", "on", "none", ""}) {
    outcome(text, at);
    CHECK(!aut.deadline());
  }
  outcome("on timeout", at);
  outcome("on acknowledged", at);
  CHECK(!aut.deadline());
  outcome("on failed", at);
  CHECK(aut.deadline() == instant(at + 5s));
  CHECK(aut.on_value("kitchen.climate.temperature", "0", instant(at)) ==
        writes{{"kitchen.fan.switch", "off"}});
  CHECK(!aut.deadline()); // another word stands

  rules once({heat()}, 0s);
  CHECK(word_at(once, "30") == "on");
  CHECK(once.watched().size() == 1);
  CHECK(once.on_value("kitchen.fan.switch.outcome", "on failed", instant{}).empty());
  CHECK(!once.deadline());
}

TEST_CASE("a rule that points a meta tuple writes references and waits for no outcome",
          "[proxy][rules][META-05]") {
  rule x;
  x.when = "home.mode";
  x.equals = {"night"};
  x.writes = {{"lamp.mi-switch", "(META 7 night.light)", "(META -1 NULL)", true},
              {"fan.switch", "on", "off"}};
  rules aut({x});
  CHECK(aut.watched() == std::vector<std::string>{"home.mode", "fan.switch.outcome"});
  CHECK(aut.written() == std::vector<std::string>{"lamp.mi-switch", "fan.switch"});
  CHECK(aut.is_meta("Lamp.MI-switch"));
  CHECK(!aut.is_meta("fan.switch"));
  CHECK(aut.on_value("home.mode", "night", instant{}) ==
        writes{{"lamp.mi-switch", "(META 7 night.light)", false, true}, {"fan.switch", "on"}});
  CHECK(aut.on_owner("lamp.mi-switch", instant{}) ==
        writes{{"lamp.mi-switch", "(META 7 night.light)", false, true}});
  CHECK(aut.on_value("home.mode", "day", instant{}) ==
        writes{{"lamp.mi-switch", "(META -1 NULL)", false, true}, {"fan.switch", "off"}});
}

namespace {

instant at(duration x) {
  return instant{} + x;
}

} // namespace

TEST_CASE("what is written after a while is written though the condition has ended since",
          "[proxy][rules]") {
  rule x;
  x.when = "hall.door.door";
  x.equals = {"open"};
  x.after = 30s;
  x.writes = {{"hall.lamp.switch", "off", "on"}};
  rules aut({x});
  aut.start(at(0s));
  CHECK(aut.on_value("hall.door.door", "open", at(10s)).empty());
  CHECK(aut.deadline() == at(40s));
  CHECK(aut.on_value("hall.door.door", "shut", at(20s)) == writes{{"hall.lamp.switch", "on"}});
  CHECK(aut.on_time(at(39s)).empty());
  CHECK(aut.on_time(at(40s)) == writes{{"hall.lamp.switch", "off"}});
  CHECK_FALSE(aut.deadline());

  static_cast<void>(aut.on_value("hall.door.door", "open", at(50s)));
  static_cast<void>(aut.on_value("hall.door.door", "shut", at(60s)));
  static_cast<void>(aut.on_value("hall.door.door", "open", at(70s))); // anew
  CHECK(aut.on_time(at(80s)).empty());
  CHECK(aut.on_time(at(100s)) == writes{{"hall.lamp.switch", "off"}});
}

TEST_CASE("a rule with a time of day writes each day at that time", "[proxy][rules]") {
  rule x;
  x.daily = 90min;
  x.writes = {{"hall.blind.position", "up", ""}};
  rules aut({x});
  CHECK(aut.watched() == std::vector<std::string>{"hall.blind.position.outcome"});
  aut.start(at(2h)); // today's is over
  CHECK(aut.deadline() == at(25h + 30min));
  CHECK(aut.on_time(at(25h)).empty());
  for (int day = 1; day <= 3; ++day)
    CHECK(aut.on_time(at(day * 24h + 90min)) == writes{{"hall.blind.position", "up"}});

  rules early({x});
  early.start(at(90min));
  CHECK(early.deadline() == at(90min));
}

TEST_CASE("with a condition a time of day decides by what holds then", "[proxy][rules]") {
  auto x = heat();
  x.daily = 7h;
  rules aut({x});
  aut.start(at(0s));
  const auto value = [&aut](const char* text, duration when) {
    return aut.on_value("kitchen.climate.temperature", text, at(when));
  };
  CHECK(aut.on_time(at(7h)).empty()); // nobody knows
  CHECK(value("30", 8h).empty());
  CHECK(value("20", 9h).empty());
  CHECK(value("26", 30h).empty());
  CHECK(value("23", 30h).empty()); // between the thresholds: as it was
  CHECK(aut.on_time(at(31h)) == writes{{"kitchen.fan.switch", "on"}});
  CHECK(value("21", 40h).empty());
  CHECK(aut.on_time(at(55h)) == writes{{"kitchen.fan.switch", "off"}});
  aut.on_gone("kitchen.climate.temperature");
  CHECK(aut.on_time(at(79h)).empty());
  CHECK(aut.deadline() == at(103h));
}

TEST_CASE("a rule writes what another tuple tells at that moment", "[proxy][rules]") {
  rule x;
  x.daily = 1h;
  x.writes = {{"robot.goal", "", "", false, "home.Plan"}};
  rules aut({x}, 0s);
  CHECK(aut.watched() == std::vector<std::string>{"home.Plan"});
  aut.start(at(0s));
  CHECK(aut.on_time(at(1h)).empty()); // nobody has it
  CHECK(aut.on_value("home.plan", "clean", at(2h)).empty());
  CHECK(aut.on_value("home.plan", "cook", at(3h)).empty());
  CHECK(aut.counters().unwatched == 0);
  CHECK(aut.on_time(at(25h)) == writes{{"robot.goal", "cook"}});
  CHECK(aut.on_owner("robot.goal", at(26h)) == writes{{"robot.goal", "cook"}});
  aut.on_gone("home.plan");
  CHECK(aut.on_time(at(49h)).empty());
}
