#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "goal/pursuer.hpp"
#include "support/catch.hpp"
#include "support/pick.hpp"

using namespace rubicon;
using namespace rubicon::goal;
using test::pick;

namespace {

constexpr std::size_t door = 0;
constexpr std::size_t load = 1;
const source opener{peer_id{32}, "opener.door"};

/// Turns for 2 s; when the door is open, drives for 10 s. Lifts what weighs from 1 to less than 5.
pursuer_config carrier() {
  pursuer_config x;
  x.name = "carrier";
  x.inputs = {{"door", "(META 32 opener.door)"}, {"load", ""}};
  x.outputs = {{"place", "dock", 4s, 0, {}}};
  goal_config drive;
  drive.text = "at kitchen";
  drive.timeout = 30s;
  drive.states.resize(2);
  drive.states[0].name = "turning";
  drive.states[0].length = 2s;
  drive.states[1].name = "driving";
  drive.states[1].length = 10s;
  drive.states[1].needs = condition{"door", {"open", "ajar"}, {}, {}};
  drive.states[1].sets = {{"place", "kitchen"}};
  goal_config lift;
  lift.text = "lift";
  lift.timeout = 5s;
  lift.states.resize(1);
  lift.states[0].name = "lifting";
  lift.states[0].length = 5s;
  lift.states[0].needs = condition{"load", {}, 1, 5};
  x.goals = {drive, lift};
  return x;
}

/// What it says, as `state=turning`; goals that begin and end are left to pick().
std::vector<std::string> said(const outputs& out) {
  std::vector<std::string> all;
  for (const auto& x : pick<publish>(out)) {
    REQUIRE(x.key.starts_with("carrier."));
    all.push_back(x.key.substr(8) + '=' + x.text);
  }
  return all;
}

using words = std::vector<std::string>;

/// A carrier that has started, and its time.
struct fixture {
  pursuer core{carrier(), random_stream(1)};
  instant now{};

  fixture() { static_cast<void>(core.start(now)); }

  /// Lets time pass, wake-up by wake-up; what it says but for its place.
  words pass(duration length) {
    words all;
    const auto end = now + length;
    while (*core.deadline() <= end) {
      now = *core.deadline();
      for (auto& x : said(core.on_time(now))) {
        if (!x.starts_with("place=dock"))
          all.push_back(std::move(x));
      }
    }
    now = end;
    return all;
  }
  words want(std::string_view goal) { return said(core.on_goal(goal, now)); }
  words input(std::size_t which, std::string_view text) {
    return said(core.on_input(which, opener, text, now));
  }
};

} // namespace

TEST_CASE("a pursuer says what it is, and where its inputs point", "[goal][SVC-10][META-04]") {
  pursuer core(carrier(), random_stream(1));
  const auto out = core.start(instant{});
  CHECK(said(out) == words{"place=dock", "door=none", "load=none", "state=idle",
                           "outcome.cause=none", "outcome=none", "goal=none"});
  const auto inputs = pick<declare>(out);
  REQUIRE(inputs.size() == 2);
  CHECK(inputs[0].key == "carrier.mi-door");
  CHECK(inputs[0].reference == "(META 32 opener.door)");
  CHECK(inputs[1].key == "carrier.mi-load");
  CHECK(inputs[1].reference.empty()); // by default its own tuple
  CHECK(inputs[1].target == "carrier.load");
  CHECK(core.goal_key() == "carrier.goal");
  CHECK(core.meta_key(load) == "carrier.mi-load");
}

TEST_CASE("a goal leads through its states and succeeds", "[goal][SVC-10]") {
  fixture x;
  x.input(door, "open");
  CHECK(x.want("at kitchen") == words{"state=turning"});
  CHECK(x.core.open_goals() == 1);
  CHECK(x.pass(2s) == words{"state=driving"});
  CHECK(x.pass(9s).empty());
  CHECK(x.pass(1s).size() == 5);
  CHECK(x.core.open_goals() == 0);
  CHECK(x.core.counters().succeeded == 1);

  fixture y; // the order of what it says at the end
  y.input(door, "open");
  y.want("at kitchen");
  y.pass(2s);
  y.now = instant{12s};
  CHECK(said(y.core.on_time(y.now)) == words{"place=kitchen", "state=idle", "outcome.cause=none",
                                             "outcome=at kitchen succeeded",
                                             "place=kitchen"}); // the last in its period
}

TEST_CASE("a state waits for what it needs, whatever else its inputs say", "[goal][SVC-10]") {
  fixture x;
  x.want("at kitchen");
  CHECK(x.pass(2s) == words{"state=waiting"});
  CHECK(x.core.doing() == pursuer::phase::waiting);
  CHECK(x.input(door, "closed").empty());
  CHECK(x.input(load, "open").empty());
  CHECK(x.input(door, "ajar") == words{"state=driving"});
  CHECK(x.input(door, "closed").empty()); // it has gone through
  CHECK(x.pass(10s).back() == "place=kitchen");
  CHECK(x.core.counters().succeeded == 1);
}

TEST_CASE("a number is needed from above on, and below", "[goal][SVC-10]") {
  const std::vector<std::pair<std::string, bool>> table{
      {"0.999", false}, {"1", true},      {"4.9", true},  {"5", false},
      {"-1", false},    {"heavy", false}, {"", false},    {"2 ", false},
      {"1e0", true},    {"nan", false},   {"inf", false}, {"3x", false}};
  for (const auto& [text, holds] : table) {
    CAPTURE(text);
    fixture x;
    x.input(load, text);
    CHECK(x.want("lift") == words{holds ? "state=lifting" : "state=waiting"});
  }
}

TEST_CASE("a goal that takes too long fails, and one that is over just then succeeds",
          "[goal][SVC-10]") {
  fixture x;
  x.want("at kitchen");
  x.pass(29s);
  CHECK(x.core.counters().failed == 0);
  CHECK(x.pass(1s) == words{"state=idle", "outcome.cause=timeout", "outcome=at kitchen failed"});
  CHECK(x.core.counters().timed_out == 1);
  CHECK(x.input(door, "open").empty()); // too late

  fixture late;
  late.want("at kitchen");
  late.pass(29s);
  late.now += 1s; // its time is over, of which it has not been notified yet
  CHECK(late.input(door, "open").empty());

  fixture y;
  y.input(load, "2");
  y.want("lift"); // 5 s, and its timeout is 5 s
  y.pass(5s);
  CHECK(y.core.counters().succeeded == 1);
  CHECK(y.core.counters().failed == 0);
}

TEST_CASE("whoever wants something else, or nothing, preempts", "[goal][SVC-10]") {
  fixture x;
  x.want("at kitchen");
  CHECK(x.want("lift") ==
        words{"outcome.cause=newer", "outcome=at kitchen preempted", "state=waiting"});
  CHECK(x.want("lift") == words{"outcome.cause=newer", "outcome=lift preempted"}); // a new goal
  CHECK(x.want("none") == words{"state=idle", "outcome.cause=cancelled", "outcome=lift preempted"});
  CHECK(x.want("none").empty());
  CHECK(x.want("").empty());
  CHECK(x.core.counters().goals == 3);
  CHECK(x.core.counters().preempted == 3);
  x.now += 60s;
  CHECK(x.pass(0s).empty());
}

TEST_CASE("an unknown goal fails at once and disturbs nothing", "[goal][SVC-10]") {
  fixture x;
  x.input(door, "open");
  x.want("at kitchen");
  CHECK(x.want("at moon") == words{"outcome.cause=unknown", "outcome=at moon failed"});
  CHECK(x.want(std::string(65, 'x')) == words{"outcome.cause=unknown", "outcome=? failed"});
  CHECK(x.want("a\nb") == words{"outcome.cause=unknown", "outcome=? failed"});
  CHECK(x.core.counters().unknown == 3);
  CHECK(x.core.open_goals() == 1);
  x.pass(12s);
  CHECK(x.core.counters().succeeded == 1);
}

TEST_CASE("an input that is another tuple forgets what the one before said",
          "[goal][SVC-10][META-05]") {
  const auto state_with = [](const auto& change) {
    fixture x;
    x.input(door, "open");
    change(x.core);
    x.want("at kitchen");
    x.pass(2s);
    return x.core.doing();
  };
  using phase = pursuer::phase;
  CHECK(state_with([](pursuer& x) {
          x.on_reference(door, source{peer_id{32}, "Opener.DOOR"});
        }) == phase::busy); // keys have no letter case
  CHECK(state_with([](pursuer& x) {
          x.on_reference(door, source{peer_id{33}, "opener.door"});
        }) == phase::waiting);
  CHECK(state_with([](pursuer& x) {
          x.on_reference(door, source{peer_id{32}, "opener.gate"});
        }) == phase::waiting);
  CHECK(state_with([](pursuer& x) { x.on_reference(door, {}); }) == phase::waiting);
  CHECK(state_with([](pursuer& x) { x.on_reference(load, {}); }) == phase::busy);
  CHECK(state_with([](pursuer& x) { x.on_input_gone(door, opener); }) == phase::waiting);
  CHECK(state_with([](pursuer& x) {
          x.on_input_gone(door, {peer_id{9}, "gate"});
        }) == phase::busy); // of the tuple before
}

TEST_CASE("outputs are told every period, and when a state sets them", "[goal][SVC-10]") {
  auto config = carrier();
  config.outputs = {
      {"place", "dock", 4s, 0, {}}, {"battery", "1", 1s, -0.4, 0.1}, {"lift", "0", 10s, 2, {}}};
  config.goals[0].states[0].sets = {{"battery", "9"}};
  pursuer core(config, random_stream(1));
  auto out = said(core.start(instant{}));
  const auto run = [&](instant until) {
    words all;
    while (*core.deadline() <= until) {
      for (auto& x : said(core.on_time(*core.deadline())))
        all.push_back(std::move(x));
    }
    return all;
  };
  CHECK(run(instant{3s}) == words{"battery=0.6", "battery=0.2", "battery=0.1"});
  CHECK(run(instant{5s}) == words{"place=dock", "battery=0.1", "battery=0.1"});
  static_cast<void>(core.on_goal("at kitchen", instant{5s}));
  CHECK(run(instant{8s}) == words{"battery=0.1", "battery=9", "state=waiting", "battery=9",
                                  "place=dock", "battery=8.6"});
  CHECK(run(instant{10s}) == words{"battery=8.2", "battery=7.8", "lift=2"});
  // A wake-up that comes late publishes each once.
  CHECK(said(core.on_time(instant{25s})).size() == 3);
  CHECK(*core.deadline() == instant{26s});
}

TEST_CASE("a state that fails ends its goal, as often as its rate says", "[goal][SVC-10]") {
  auto config = carrier();
  config.goals[1].states[0] = {"lifting", 1s, 500ms, 0.25, {}, {{"place", "sky"}}};
  pursuer core(config, random_stream(3));
  static_cast<void>(core.start(instant{}));
  instant now{};
  duration longest{};
  for (int i = 0; i < 1000; ++i) {
    const auto begin = now;
    static_cast<void>(core.on_goal("lift", now));
    while (core.open_goals() > 0) {
      now = *core.deadline();
      const auto out = core.on_time(now);
      for (const auto& x : pick<ended>(out)) {
        const bool failed = x.outcome == goal_outcome::failed;
        CHECK(x.cause == (failed ? goal_cause::broken : goal_cause::none));
        const auto texts = said(out);
        CHECK((std::ranges::find(texts, "place=sky") == texts.end()) == failed);
      }
    }
    CHECK(now - begin >= 1s);
    CHECK(now - begin <= 1500ms);
    longest = std::max(longest, now - begin);
  }
  CHECK(longest > 1400ms);
  CHECK(core.counters().failed > 200);
  CHECK(core.counters().failed < 300);
  CHECK(core.counters().succeeded + core.counters().failed == 1000);
}
