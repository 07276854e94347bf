#include <string>

#include "config/run/summary.hpp"
#include "support/catch.hpp"
#include "unit/config/sample.hpp"

using namespace rubicon;
using namespace rubicon::config;
using namespace rubicon::test;

namespace {

/// head, whose peer pursues goals; what follows stands from line 8.
const std::string goal_head = std::string(head) + "[[peer.apps]]\napp = \"goal\"\n";

/// The same, with an input and two outputs, up to line 10.
const std::string robot_head = goal_head + "inputs = [{ name = \"door\" }]\n"
                                           "outputs = [{ name = \"place\", value = \"dock\" },\n"
                                           "{ name = \"load\", value = 1, step = 1 }]\n";

std::string goal_with(const std::string& states) {
  return robot_head + "[[peer.apps.goals]]\ngoal = \"go\"\nstates = [" + states + "]\n";
}

} // namespace

TEST_CASE("a pursuer of goals arrives with all its keys", "[config][SVC-10]") {
  const auto x = good(std::string(head) + R"(
[[peer.apps]]
app = "goal"
name = "arm"
inputs = [{ name = "door", from = "pc:arm.place" }, { name = "load" },
          { name = "far", from = "7:door.state" }, { name = "none", from = "nowhere" }]
outputs = [{ name = "place", value = "dock", every = "5s" },
           { name = "battery", value = 99.5, step = -0.5, until = 0 }]
[[peer.apps.goals]]
goal = "at kitchen"
timeout = "2min"
states = [
  { state = "turning", for = "2s", jitter = "1s", failure_rate = "10%" },
  { state = "driving", for = "8s", input = "door", equals = ["open", "ajar"], sets = { place = "kitchen", battery = 7 } },
]
[[peer.apps.goals]]
goal = "lift"
states = [{ state = "lifting", for = "1s", input = "load", above = 1, below = 5.5 }]
)");
  const auto& arm = std::get<goal::pursuer_config>(x.peers.at(0).apps.at(0));
  CHECK(arm.name == "arm");
  REQUIRE(arm.inputs.size() == 4);
  CHECK(arm.inputs[0].name == "door");
  CHECK(arm.inputs[0].reference == "(META 300 arm.place)");
  CHECK(arm.inputs[1].reference.empty());
  CHECK(arm.inputs[2].reference == "(META 7 door.state)");
  CHECK(arm.inputs[3].reference == "(META -1 NULL)");
  REQUIRE(arm.outputs.size() == 2);
  CHECK(arm.outputs[0].value == "dock");
  CHECK(arm.outputs[0].every == 5s);
  CHECK(arm.outputs[0].step == 0);
  CHECK(arm.outputs[1].value == "99.5");
  CHECK(arm.outputs[1].every == 1s);
  CHECK(arm.outputs[1].step == -0.5);
  CHECK(arm.outputs[1].until == 0.0);
  REQUIRE(arm.goals.size() == 2);
  CHECK(arm.goals[0].text == "at kitchen");
  CHECK(arm.goals[0].timeout == 2min);
  REQUIRE(arm.goals[0].states.size() == 2);
  const auto& turning = arm.goals[0].states[0];
  CHECK(turning.name == "turning");
  CHECK(turning.length == 2s);
  CHECK(turning.jitter == 1s);
  CHECK(turning.failure_rate == 0.1);
  CHECK(!turning.needs);
  const auto& driving = arm.goals[0].states[1];
  REQUIRE(driving.needs);
  CHECK(driving.needs->input == "door");
  CHECK(driving.needs->equals == std::vector<std::string>{"open", "ajar"});
  CHECK(driving.sets ==
        std::vector<std::pair<std::string, std::string>>{{"place", "kitchen"}, {"battery", "7"}});
  CHECK(arm.goals[1].timeout == 1min);
  CHECK(arm.goals[1].states.at(0).needs->above == 1.0);
  CHECK(arm.goals[1].states.at(0).needs->below == 5.5);
}

TEST_CASE("pursuers are called as their peers, if they have no name", "[config][SVC-10]") {
  const auto x = good(std::string(head) + "count = 2\napps = [{ app = \"goal\" }]\n").peers;
  REQUIRE(x.size() == 2);
  for (const auto& peer : x)
    CHECK(std::get<goal::pursuer_config>(peer.apps.at(0)).name == peer.name);
}

TEST_CASE("what is wrong with a pursuer of goals is said", "[config][SVC-10]") {
  const std::vector<row> after_head{
      {"inputs = [{}]\n", "8:11: `name` is missing in inputs of a goal app"},
      {"inputs = [{ name = \"goal\" }]\n", "8:20: `goal` is a tuple of its own"},
      {"inputs = [{ name = \"a\" }]\noutputs = [{ name = \"A\", value = 1 }]\n",
       "9:21: name `A` is already taken (line 8, column 20)"},
      {"inputs = [{ name = \"a\" }]\noutputs = [{ name = \"mi-a\", value = 1 }]\n",
       "9:21: name `mi-a` is already taken (line 8, column 20)"},
      {"inputs = [{ name = \"abcdefghijabcdefghijabcdefghij\" }]\n",
       "8:20: `mi-abcdefghijabcdefghijabcdefghij` would be longer than 32 characters"},
      {"inputs = [{ name = \"a\", from = \"b\" }]\n",
       "8:32: `from` must be a tuple of a peer or gateway, as in \"robot:robot.state\", or "
       "\"nowhere\", not \"b\""},
      {"inputs = [{ name = \"a\", from = \"pd:b\" }]\n",
       "8:32: no peer or gateway is named `pd`: did you mean `pc`?"},
      {"inputs = [{ name = \"a\", from = \"0:b\" }]\n",
       "8:32: no peer or gateway is named `0`: there is pc"},
      {"inputs = [{ name = \"a\", from = \"pc:b.*\" }]\n",
       "8:32: `from` must be a tuple key of 1 to 7 parts between dots, each of letters, digits, - "
       "and _, not \"b.*\""},
      {"outputs = [{ name = \"a\" }]\n", "8:12: `value` is missing in outputs of a goal app"},
      {"outputs = [{ name = \"a\", value = true }]\n",
       "8:34: `value` must be a text or a number, not true"},
      {"outputs = [{ name = \"a\", value = \"b\", step = 1 }]\n",
       "8:46: `step` needs a number as `value`, not \"b\""},
      {"outputs = [{ name = \"a\", value = 1, until = 2 }]\n",
       "8:45: `until` has no effect without `step`"},
      {"goals = [{ goal = \"none\", states = [{ state = \"a\", for = \"1s\" }] }]\n",
       "8:19: `none` stands for no goal"},
      {"goals = [{ goal = \"a\" }]\n", "8:10: `states` is missing in goals"},
      {"goals = [{ goal = \"a\", states = [] }]\n",
       "8:33: `states` must be an array of at least 1, not an empty array"},
      {"[[peer.apps]]\napp = \"goal\"\n", "9:7: pursuer `pc` is already taken (line 7, column 7)"},
  };
  for (const auto& [toml, problem] : after_head) {
    CAPTURE(toml);
    CHECK(problem_in(goal_head + toml) == problem);
  }
  const std::vector<row> states{
      {"{ state = \"a\" }", "13:11: `for` is missing in states"},
      {"{ state = \"a\", for = \"0s\" }",
       "13:32: `for` must be a time from 1 ms to 10 d, not \"0s\""},
      {"{ state = \"idle\", for = \"1s\" }", "13:21: `idle` is its value in between"},
      {"{ state = \"a\", for = \"1s\", input = \"gate\", equals = [\"b\"] }",
       "13:46: the app has no input `gate`"},
      {"{ state = \"a\", for = \"1s\", input = \"door\" }",
       "13:11: `input` and its condition must be given together"},
      {"{ state = \"a\", for = \"1s\", above = 1 }",
       "13:11: `input` and its condition must be given together"},
      {"{ state = \"a\", for = \"1s\", input = \"door\", above = 2, below = 2 }",
       "13:73: `below` must be more than `above`, which is 2"},
      {"{ state = \"a\", for = \"1s\", input = \"door\", above = 2, equals = [\"b\"] }",
       "13:74: a state needs either `equals`, or `above`, `below` or both"},
      {"{ state = \"a\", for = \"1s\", sets = { plaice = \"b\" } }",
       "13:47: the app has no output `plaice`"},
      {"{ state = \"a\", for = \"1s\", sets = { load = \"b\" } }",
       "13:47: `load` has a `step` and must be a number, not \"b\""},
  };
  for (const auto& [toml, problem] : states) {
    CAPTURE(toml);
    CHECK(problem_in(goal_with(toml)) == problem);
  }
}

TEST_CASE("a rule points a meta tuple at a tuple of a peer", "[config][rules][META-05]") {
  const auto rules_of = [](const std::string& rule) {
    return std::string(head) + "[[peer.apps]]\napp = \"rules\"\nrules = [" + rule + "]\n";
  };
  const auto x = good(rules_of("{ when = \"a\", equals = [\"b\"], point = \"lamp.mi-switch\", "
                               "then = \"pc:night.light\", otherwise = \"nowhere\" }, "
                               "{ when = \"a\", above = 1, writes = [{ point = \"c.mi-d\", "
                               "then = \"9:e\" }, { write = \"f\", then = \"on\" }] }"));
  const auto& rules = std::get<proxy::rules_config>(x.peers.at(0).apps.at(0)).rules;
  REQUIRE(rules.size() == 2);
  const auto& one = rules[0].writes.at(0);
  CHECK(one.meta);
  CHECK(one.key == "lamp.mi-switch");
  CHECK(one.then == "(META 300 night.light)");
  CHECK(one.otherwise == "(META -1 NULL)");
  REQUIRE(rules[1].writes.size() == 2);
  CHECK(rules[1].writes[0].meta);
  CHECK(rules[1].writes[0].then == "(META 9 e)");
  CHECK(!rules[1].writes[1].meta);
  CHECK(rules[1].writes[1].then == "on");

  const std::string rule = "{ when = \"a\", above = 1, ";
  CHECK(problem_in(rules_of(rule + "point = \"b\", write = \"b\", then = \"pc:c\" }")) ==
        "8:56: a rule has either `write` or `point`");
  CHECK(problem_in(rules_of(rule + "point = \"b\", then = \"on\" }")) ==
        "8:55: `then` must be a tuple of a peer or gateway, as in \"robot:robot.state\", or "
        "\"nowhere\", not \"on\"");
  CHECK(problem_in(rules_of(rule + "point = \"b\" }")) ==
        "8:10: a rule needs `then`, `otherwise` or both");
  CHECK(problem_in(rules_of(rule + "then = \"on\" }")) == "8:10: `write` is missing in rules");
  CHECK(problem_in(rules_of(rule + "point = \"b\", then = \"pc:c\" }, " + rule +
                            "write = \"B\", then = \"on\" }")) ==
        "8:9: `b` has `write` in one rule and `point` in another");
}

TEST_CASE("an input of a proxy may be any tuple", "[config][META-05]") {
  const std::string words = "words = { on = \"01\" }\n";
  CHECK(!good(input_head + words).proxies.at(0).inputs.at(0).meta);
  CHECK(good(input_head + "meta = true\n" + words).proxies.at(0).inputs.at(0).meta);
  CHECK(problem_in(input_head + "meta = true\n" + words +
                   "[[proxy.input]]\nname = \"mi-i\"\nchannel = 3\n" + words) ==
        "15:8: name `mi-i` is already taken (line 12, column 8)");
}
