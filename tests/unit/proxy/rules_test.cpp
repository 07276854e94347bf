#include <clocale>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "proxy/rules/rules.hpp"
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
  CHECK(aut.counters_of_rules().at(0).writes == 5);
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
  CHECK(aut.counters().unread_values == bad.size());
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
  CHECK(aut.counters().unwatched_keys == 1);
  CHECK(aut.on_value("hall.temperature", "0", instant{}) == writes{{"kitchen.fan.switch", "off"}});
}

TEST_CASE("a new owner is sent the word that stands", "[proxy][rules]") {
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
  silent.on_written("kitchen.fan.switch", write_end::accepted, "", instant{});
  CHECK(word_at(silent, "0").empty());
  CHECK(
      silent.on_owner("kitchen.fan.switch", instant{}).empty()); // its time is over, and one had it
}

TEST_CASE("a rule without `otherwise` whose condition does not hold changes nothing",
          "[proxy][rules]") {
  rule warm;
  warm.when = "store.warm";
  warm.above = 30;
  warm.writes = {{"store.goal", "vent", {}}};
  auto wet = warm;
  wet.when = "store.wet";
  wet.above = 80;
  rules aut({warm, wet});
  const writes vent{{"store.goal", "vent"}};
  CHECK(aut.on_value("store.warm", "31.5", instant{}) == vent);
  aut.on_unowned("store.goal", instant{});
  CHECK(aut.on_value("store.wet", "45", instant{}).empty());
  CHECK(aut.on_value("store.warm", "20", instant{}).empty()); // nor does its own
  CHECK(aut.on_owner("store.goal", instant(1ms)) == vent);
  CHECK(aut.counters_of_rules()[0].writes == 1);
  CHECK(aut.counters_of_rules()[1] == write_counters{});
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
  CHECK(aut.counters().unread_values == 0);
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

TEST_CASE("a time of day comes once a day through daylight saving", "[proxy][rules]") {
  const auto daily = [](duration time, const std::vector<proxy::clock_change>& changes) {
    std::vector<duration> all;
    for (auto from = instant{}; all.size() < 4; from = instant{} + all.back() + 1ns)
      all.push_back(proxy::next_daily(time, changes, from) - instant{});
    return all;
  };
  using times = std::vector<duration>;
  const std::vector<proxy::clock_change> spring{{at(26h), 1h}};
  CHECK(daily(1h, spring) == times{1h, 25h, 48h, 72h});
  CHECK(daily(2h + 30min, spring) == times{2h + 30min, 26h, 49h + 30min, 73h + 30min}); // left out
  CHECK(daily(7h, spring) == times{7h, 30h, 54h, 78h});
  const std::vector<proxy::clock_change> autumn{{at(27h), -1h}};
  CHECK(daily(1h, autumn) == times{1h, 25h, 50h, 74h});
  CHECK(daily(2h + 30min, autumn) == times{2h + 30min, 26h + 30min, 51h + 30min, 75h + 30min});
  CHECK(daily(7h, autumn) == times{7h, 32h, 56h, 80h});
  const std::vector<proxy::clock_change> both{{at(26h), 1h}, {at(60h), 0h}};
  CHECK(daily(7h, both) == times{7h, 30h, 54h, 79h});

  rule x;
  x.daily = 7h;
  x.writes = {{"hall.blind.position", "up", ""}};
  rules aut({x}, 5s, spring);
  aut.start(at(8h));
  CHECK(aut.deadline() == at(30h));
  CHECK(aut.on_time(at(30h)) == writes{{"hall.blind.position", "up"}});
  CHECK(aut.deadline() == at(54h));
}

TEST_CASE("with a condition a time of day decides by what holds then", "[proxy][rules]") {
  auto x = heat();
  x.daily = 7h;
  rules aut({x});
  aut.start(at(0s));
  const auto value = [&aut](const char* text, duration when) {
    return aut.on_value("kitchen.climate.temperature", text, at(when));
  };
  CHECK(aut.on_time(at(7h)).empty()); // it is not known
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

TEST_CASE("a rule writes what another tuple holds at that moment", "[proxy][rules]") {
  rule x;
  x.daily = 1h;
  x.writes = {{"robot.goal", "", "", false, "home.Plan"}};
  rules aut({x}, 0s);
  CHECK(aut.watched() == std::vector<std::string>{"home.Plan"});
  aut.start(at(0s));
  CHECK(aut.on_time(at(1h)).empty()); // no peer has it
  CHECK(aut.on_value("home.plan", "clean", at(2h)).empty());
  CHECK(aut.on_value("home.plan", "cook", at(3h)).empty());
  CHECK(aut.counters().unwatched_keys == 0);
  CHECK(aut.on_time(at(25h)) == writes{{"robot.goal", "cook"}});
  CHECK(aut.on_owner("robot.goal", at(26h)) == writes{{"robot.goal", "cook"}});
  aut.on_gone("home.plan");
  CHECK(aut.on_time(at(49h)).empty());
}

namespace {

constexpr auto key = "kitchen.fan.switch";

/// One rule that has written `on`.
struct written {
  explicit written(rule x = heat()) : aut({std::move(x)}, 5s) { CHECK(word_at(aut, "30") == "on"); }

  void ends(write_end end, duration when, std::string_view cause = "") {
    aut.on_written(key, end, cause, at(when));
  }
  [[nodiscard]] const write_counters& counted() const { return aut.counters_of_rules()[0]; }
  [[nodiscard]] std::string story() {
    const auto all = aut.take_notices();
    CHECK(all.size() <= 1);
    return all.empty() ? "" : all.front();
  }

  rules aut;
};

} // namespace

TEST_CASE("a write that its owner has is accepted, and not reported", "[proxy][rules]") {
  written x;
  x.ends(write_end::accepted, 1ms);
  CHECK(x.counted() == write_counters{1, 1, 0, 0, 0});
  CHECK(x.story().empty());
  x.aut.on_owner_gone(key, at(1min)); // long after
  CHECK(x.aut.on_owner(key, at(2min), true).empty());
  CHECK(x.counted() == write_counters{1, 1, 0, 0, 0});
}

TEST_CASE("a write that its owner refuses is not repeated", "[proxy][rules]") {
  written x;
  x.ends(write_end::refused, 1ms, "bad_value");
  CHECK(x.counted() == write_counters{1, 0, 1, 0, 0});
  CHECK(x.story() == "kitchen.fan.switch = on is refused: bad_value");
  CHECK(!x.aut.deadline());
  CHECK(x.aut.on_owner(key, at(1s), true).empty());

  written by_proxy;
  by_proxy.ends(write_end::accepted, 1ms);
  static_cast<void>(by_proxy.aut.on_value("kitchen.fan.switch.outcome", "on refused", at(1s)));
  CHECK(by_proxy.counted() == write_counters{1, 0, 1, 0, 0});
  CHECK(by_proxy.story() == "kitchen.fan.switch = on: refused by its proxy");
}

TEST_CASE("a write to an owner that is away is repeated, and when the owner is back",
          "[proxy][rules]") {
  const writes again{{key, "on", true}};
  written x;
  x.ends(write_end::unreached, 1s, "no_route");
  CHECK(x.story() == "kitchen.fan.switch = on waits: its owner is away (no_route)");
  CHECK(x.aut.deadline() == at(6s));
  CHECK(x.aut.on_time(at(6s)) == again);
  x.ends(write_end::unreached, 7s, "no_route");
  CHECK(x.story().empty()); // reported once
  CHECK(x.aut.deadline() == at(17s));
  CHECK(x.aut.on_owner(key, at(10s), true) == again);
  CHECK(!x.aut.deadline());
  x.ends(write_end::accepted, 11s);
  CHECK(x.story() == "kitchen.fan.switch = on has arrived, 11 s late");
  CHECK(x.counted() == write_counters{1, 1, 0, 0, 0});
}

TEST_CASE("an owner that goes at once may not have acted", "[proxy][rules]") {
  written x;
  x.ends(write_end::accepted, 1s);
  x.aut.on_owner_gone(key, at(20s));
  CHECK(x.story() == "kitchen.fan.switch = on waits: its owner ended, and may not have acted");
  CHECK(x.counted() == write_counters{1, 0, 0, 0, 0});
  CHECK(x.aut.on_owner(key, at(40s), true) == writes{{key, "on", true}});
  x.ends(write_end::accepted, 41s);
  CHECK(x.counted() == write_counters{1, 1, 0, 0, 0});

  written done; // its proxy has reported that the mote has it
  done.ends(write_end::accepted, 1s);
  static_cast<void>(done.aut.on_value("kitchen.fan.switch.outcome", "on acknowledged", at(2s)));
  done.aut.on_owner_gone(key, at(3s));
  CHECK(done.aut.on_owner(key, at(20s), true).empty());
  CHECK(done.story().empty());
}

TEST_CASE("with `retry = false` a write that is lost is lost", "[proxy][rules]") {
  auto once = heat();
  once.retry = false;
  written away(once);
  away.ends(write_end::unreached, 1s, "host_gone");
  CHECK(away.counted() == write_counters{1, 0, 0, 0, 1});
  CHECK(away.story() == "kitchen.fan.switch = on is lost: its owner is away (host_gone)");
  CHECK(!away.aut.deadline());
  CHECK(away.aut.on_owner(key, at(5s), true).empty());
  written gone(once);
  gone.ends(write_end::accepted, 1s);
  gone.aut.on_owner_gone(key, at(2s));
  CHECK(gone.counted() == write_counters{1, 0, 0, 0, 1});
  CHECK(gone.aut.on_owner(key, at(5s), true).empty());
}

TEST_CASE("a word that waits is reported after a while, and replaced by the next",
          "[proxy][rules]") {
  written x;
  x.aut.on_unowned(key, at(0s));
  CHECK(x.story().empty());
  CHECK(x.aut.deadline() == at(10s));
  CHECK(x.aut.on_time(at(10s)).empty());
  CHECK(x.story() == "kitchen.fan.switch = on waits: no peer has that tuple");
  CHECK(word_at(x.aut, "0") == "off");
  CHECK(x.story() == "kitchen.fan.switch = on is replaced by off before its owner had it");
  CHECK(x.counted() == write_counters{2, 0, 0, 1, 0});
}

TEST_CASE("the first text of a tuple that is no number is reported", "[proxy][rules]") {
  rules aut({heat()});
  CHECK(word_at(aut, "27,5").empty());
  CHECK(word_at(aut, "nan").empty());
  CHECK(aut.take_notices() ==
        std::vector<std::string>{
            "cannot read kitchen.climate.temperature = \"27,5\": that is no number"});
  CHECK(aut.counters().unread_values == 2);
}

TEST_CASE("a time of day that has passed while the rules were away is made up for",
          "[proxy][rules]") {
  rule x;
  x.daily = 5min;
  x.writes = {{"hall.blind.target", "100", {}}};
  rules late({x});
  late.start(at(5min + 12s), at(4min + 57s));
  CHECK(late.on_time(at(5min + 12s)) == writes{{"hall.blind.target", "100"}});
  CHECK(late.take_notices() ==
        std::vector<std::string>{"the time of a rule that writes hall.blind.target has passed "
                                 "while the rules were away, 12 s ago"});
  CHECK(late.deadline() == at(24h + 5min));
  rules done({x});
  done.start(at(5min + 12s), at(5min + 1s)); // away since then only
  CHECK(done.on_time(at(5min + 12s)).empty());
  rules too_late({x});
  too_late.start(at(2h), at(1min));
  CHECK(too_late.on_time(at(2h)).empty());
  CHECK(too_late.counters().times_missed == 1);
  x.retry = false;
  rules never({x});
  never.start(at(5min + 12s), at(4min));
  CHECK(never.on_time(at(5min + 12s)).empty());
  CHECK(never.counters().times_missed == 1);

  auto warm = heat(); // with a condition: as soon as that is known
  warm.daily = 5min;
  rules conditional({warm});
  conditional.start(at(5min + 12s), at(4min));
  CHECK(conditional.on_time(at(5min + 12s)).empty());
  CHECK(conditional.on_value("kitchen.climate.temperature", "30", at(5min + 13s)) ==
        writes{{key, "on"}});
  CHECK(conditional.on_value("kitchen.climate.temperature", "0", at(5min + 14s)).empty());
}
