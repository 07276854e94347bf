#include "actors/messages/common.hpp"
#include "actors/messages/peis.hpp"
#include "actors/messages/services.hpp"
#include "actors/messages/supervision.hpp"
#include "actors/peis/component.hpp"
#include "actors/sample_class.hpp"
#include "goal/component.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using test::fake;
using test::fixture;
using test::set_watched;
using test::text_value;
using test::tuple_at;
using test::watch_on;

namespace {

constexpr peer_id pursuer{31};
constexpr peer_id opener{32};
const std::string meta_key = "robot.mi-door";

struct goal_fixture {
  fixture world;
  fake<peis_peer_actor> peer{world};
  fake<ecology_actor> ecology{world};
  timed_peer_app_actor app;

  goal_fixture() {
    goal::pursuer_config x;
    x.name = "robot";
    x.inputs = {{"door", ""}};
    x.outputs = {{"place", "dock", 10s, 0, {}}};
    x.goals.resize(1);
    x.goals[0].text = "at kitchen";
    x.goals[0].timeout = 20s;
    x.goals[0].states.resize(1);
    x.goals[0].states[0].name = "driving";
    x.goals[0].states[0].length = 5s;
    x.goals[0].states[0].needs = goal::condition{"door", {"open"}, {}, {}};
    x.goals[0].states[0].sets = {{"place", "kitchen"}};
    component_arguments made;
    made.core = std::make_shared<goal::component>(goal::pursuer(x, random_stream(1)), pursuer);
    made.who = "robot";
    made.kind = "goal";
    made.self = pursuer;
    made.peer = peer.handle();
    made.ecology = ecology.handle();
    app = world.spawn_at("peer_app/robot/goal-1", component_behavior, std::move(made));
  }

  void want(std::string_view goal) { set_watched(world, peer, "robot.goal", text_value(goal)); }
  void point(std::string_view reference) {
    set_watched(world, peer, meta_key, text_value(reference));
  }

  /// The tuple that the input is has a value.
  void door(peer_id owner, std::string_view value, bool deleted = false) {
    const auto watch = peer.all<watch_indirectly>().at(0);
    world.send(watch.client,
               tuple_event{watch.watch, owner, "opener.door", text_value(value), deleted});
  }
  [[nodiscard]] std::string told(std::string_view name) const {
    return tuple_at(peer, "robot." + std::string(name));
  }
};

} // namespace

TEST_CASE("a pursuer declares and follows the meta tuple of its input",
          "[actors][goal][SVC-10][META-04][ACT-01]") {
  goal_fixture x;
  const auto declared = x.peer.all<declare_meta_tuple>();
  REQUIRE(declared.size() == 1);
  CHECK(declared[0].key == meta_key);
  CHECK(declared[0].reference == "(META 31 robot.door)");
  const auto followed = x.peer.all<watch_indirectly>();
  REQUIRE(followed.size() == 1);
  CHECK(followed[0].owner == pursuer);
  CHECK(followed[0].key == meta_key);
  CHECK(watch_on(x.peer, meta_key).owner == pursuer);
  CHECK(watch_on(x.peer, "robot.goal").owner == pursuer);
  CHECK(x.told("goal") == "none");
}

TEST_CASE("a goal that is written is pursued in time, and its end told", "[actors][goal][SVC-10]") {
  goal_fixture x;
  x.want("at kitchen");
  CHECK(x.told("state") == "waiting");
  x.door(opener, "open");
  CHECK(x.told("state") == "driving");
  x.world.run_for(5s - 1ns);
  CHECK(x.told("outcome") == "none");
  x.world.run_for(1ns);
  CHECK(x.told("outcome") == "at kitchen succeeded");
  CHECK(x.told("place") == "kitchen");
  const auto events = x.ecology.all<notable_event>();
  REQUIRE(events.size() == 2);
  CHECK(events[0].who == "robot");
  CHECK(events[0].what == "goal: at kitchen");
  CHECK(events[1].what == "at kitchen succeeded");
  x.door(opener, "closed");
  x.want("at kitchen");
  x.world.run_for(20s);
  CHECK(x.told("outcome") == "at kitchen failed");
  CHECK(x.ecology.all<notable_event>().back().what == "at kitchen failed: timeout");
  x.world.send(x.app, status_request{});
  REQUIRE(x.ecology.count<program_status>() == 1);
  const auto report = x.ecology.all<program_status>()[0].program;
  CHECK(report.who == "robot");
  CHECK(report.kind == "goal");
  CHECK(report.figures == std::vector<std::pair<std::string, double>>{{"goals", 2},
                                                                      {"succeeded", 1},
                                                                      {"failed", 1},
                                                                      {"preempted", 0},
                                                                      {"timed out", 1},
                                                                      {"unknown", 0},
                                                                      {"open", 0}});
}

TEST_CASE("what an input was is forgotten when it is pointed elsewhere, or is gone",
          "[actors][goal][SVC-10][META-05]") {
  const auto state_after = [](const auto& change) {
    goal_fixture x;
    x.door(opener, "open");
    change(x);
    x.want("at kitchen");
    return x.told("state");
  };
  CHECK(state_after([](goal_fixture& x) { x.point("(META 32 opener.door)"); }) == "driving");
  CHECK(state_after([](goal_fixture& x) { x.point("(META 33 opener.door)"); }) == "waiting");
  CHECK(state_after([](goal_fixture& x) { x.point("(META -1 NULL)"); }) == "waiting");
  CHECK(state_after([](goal_fixture& x) { x.point("rubbish"); }) == "waiting");
  CHECK(state_after([](goal_fixture& x) { x.door(opener, "open", true); }) == "waiting");
  CHECK(state_after([](goal_fixture& x) { x.door(pursuer, "open", true); }) ==
        "driving"); // of another
}
