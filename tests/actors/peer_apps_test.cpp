#include "actors/peis/component.hpp"
#include "actors/sample_class.hpp"
#include "proxy/collector.hpp"
#include "proxy/rules/rules_component.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using test::fake;
using test::fixture;
using test::set_watched;
using test::text_value;
using test::watch_on;

namespace {

constexpr peer_id fan_owner{11};

/// A component on the robot's peer.
timed_peer_app_actor hosted(fixture& world, const fake<peis_peer_actor>& peer,
                            const fake<ecology_actor>& ecology, std::string kind,
                            std::shared_ptr<components::component> core) {
  component_arguments x;
  x.core = std::move(core);
  x.who = "robot";
  x.kind = kind;
  x.self = peer_id{9};
  x.peer = peer.handle();
  x.ecology = ecology.handle();
  return world.spawn_at("peer_app/care-pc/" + kind + "-1", component_behavior, std::move(x));
}

struct peer_apps_fixture {
  fixture world;
  fake<peis_peer_actor> peer{world};
  fake<ecology_actor> ecology{world};
  timed_peer_app_actor rules;

  peer_apps_fixture() {
    proxy::rule rule;
    rule.when = "kitchen.stove.temperature";
    rule.above = 26;
    rule.below = 24;
    rule.writes = {{"kitchen.fan.switch", "on", "off"}};
    rules = hosted(world, peer, ecology, "rules",
                   std::make_shared<proxy::rules_component>(proxy::rules({rule})));
  }

  void read(std::string_view temperature) {
    set_watched(world, peer, "kitchen.stove.temperature", text_value(temperature));
  }

  void find_fan(peer_id owner) {
    const auto watch = watch_on(peer, "kitchen.fan.switch");
    world.send(rules, tuple_event{watch.watch, owner, watch.key, text_value("none"), false});
  }

  /// `owner:word` of every write so far.
  [[nodiscard]] std::vector<std::string> writes() const {
    std::vector<std::string> found;
    for (const auto& x : peer.all<set_remote_tuple>()) {
      CHECK(x.key == "kitchen.fan.switch");
      CHECK(x.text);
      found.push_back(to_string(x.owner) + ':' + to_string(x.value.view()));
    }
    return found;
  }
};

} // namespace

TEST_CASE("rules watch what they read and look for what they write, whoever owns it",
          "[actors][rules][ACT-01]") {
  peer_apps_fixture x;
  CHECK(x.peer.count<watch_tuples>() == 3); // the outcome, too
  CHECK(watch_on(x.peer, "kitchen.stove.temperature").owner == any_peer);
  CHECK(watch_on(x.peer, "kitchen.fan.switch").owner == any_peer);
}

TEST_CASE("a rule writes once when its threshold is passed, and not in between",
          "[actors][rules]") {
  peer_apps_fixture x;
  x.find_fan(fan_owner);
  for (const auto* const reading : {"25.0", "25.9", "26.0", "27.5", "25.0", "24.0"})
    x.read(reading);
  CHECK(x.writes() == std::vector<std::string>{"11:on"});
  x.read("23.9");
  x.read("hot");
  CHECK(x.writes() == std::vector<std::string>{"11:on", "11:off"});
  REQUIRE(x.ecology.count<notable_event>() == 4);
  const auto told = x.ecology.all<notable_event>();
  CHECK(told[0].who == "peer_app/care-pc/rules-1");
  CHECK(told[0].what == "writes kitchen.fan.switch = on");
  CHECK(told[1].what == "writes kitchen.fan.switch = off");
  CHECK(told[2].what == "kitchen.fan.switch = on is replaced by off before its owner had it");
  CHECK(told[3].what == "cannot read kitchen.stove.temperature = \"hot\": that is no number");
}

TEST_CASE("what becomes of a rule's write is counted", "[actors][rules]") {
  peer_apps_fixture x;
  x.find_fan(fan_owner);
  x.read("30");
  const auto token = x.peer.all<set_remote_tuple>().back().token;
  x.world.send(x.rules, peis_outcome{token, false, "no_route"});
  x.world.send(x.rules, peis_outcome{token + 9, true, ""}); // somebody else's
  x.world.run_for(5s);
  CHECK(x.writes() == std::vector<std::string>{"11:on", "11:on"});
  x.world.send(x.rules, peis_outcome{x.peer.all<set_remote_tuple>().back().token, true, ""});
  const auto watch = watch_on(x.peer, "kitchen.fan.switch");
  x.world.send(x.rules, tuple_event{watch.watch, fan_owner, watch.key, text_value("on"), true});
  x.find_fan(fan_owner); // back so soon: it may not have acted
  CHECK(x.writes().size() == 3);
  x.world.send(x.rules, peis_outcome{x.peer.all<set_remote_tuple>().back().token, true, ""});
  x.world.send(x.rules, status_request{});
  const auto figures = x.ecology.all<program_status>().back().program.figures;
  const auto figure = [&figures](std::string_view name) {
    for (const auto& [each, value] : figures)
      if (each == name)
        return value;
    return -1.0;
  };
  CHECK(figure("writes") == 1);
  CHECK(figure("accepted") == 1);
  CHECK(figure("lost") == 0);
  CHECK(figure("waiting") == 0);
  CHECK(figure("repeats") == 1);
}

TEST_CASE("a rule that does not know its tuple's owner writes when it finds one",
          "[actors][rules]") {
  peer_apps_fixture x;
  x.read("30");
  CHECK(x.writes().empty());
  x.find_fan(fan_owner);
  CHECK(x.writes() == std::vector<std::string>{"11:on"});
  x.find_fan(fan_owner); // its own write comes back
  CHECK(x.writes().size() == 1);
  x.find_fan(peer_id{12}); // the tuple has moved
  CHECK(x.writes() == std::vector<std::string>{"11:on", "12:on"});
}

TEST_CASE("deleted tuples and failed writes do not disturb a rule", "[actors][rules]") {
  peer_apps_fixture x;
  x.find_fan(fan_owner);
  const auto watch = watch_on(x.peer, "kitchen.stove.temperature");
  x.world.send(x.rules, tuple_event{watch.watch, peer_id{3}, watch.key, text_value("30"), true});
  CHECK(x.writes().empty());
  x.world.send(x.rules, peis_outcome{0, false, "host_gone"});
  CHECK(x.world.logged("write_failed cause=host_gone") == 1);
  x.read("30");
  CHECK(x.writes() == std::vector<std::string>{"11:on"});
}

TEST_CASE("a collector asks for its period whenever a mote is listed whose outputs it names",
          "[actors][collector][IF-04]") {
  fixture world;
  fake<peis_peer_actor> peer(world);
  const std::vector<std::string> keys{"devices.*.output.1", "devices.8.output.2", "devices.*.type"};
  fake<ecology_actor> ecology(world);
  const auto app =
      hosted(world, peer, ecology, "collector", std::make_shared<proxy::collector>(keys, 250ms));
  CHECK(watch_on(peer, "devices.*.status").owner == any_peer);
  const auto watch = watch_on(peer, "devices.*.status").watch;
  const auto tell = [&](int owner, const char* key, const char* value) {
    world.send(app, tuple_event{watch, peer_id{owner}, key, text_value(value)});
  };
  const auto asked = [&] {
    std::vector<std::string> all;
    for (const auto& x : peer.all<set_remote_tuple>())
      all.push_back(to_string(x.owner) + ' ' + x.key + ' ' + to_string(x.value.view()));
    peer.forget();
    return all;
  };
  tell(1, "devices.7.status", "listed 1.000000");
  CHECK(asked() == std::vector<std::string>{"1 devices.7.output.1.period 250"});
  tell(2, "devices.8.status", "listed 1.000000");
  CHECK(asked() == std::vector<std::string>{"2 devices.8.output.1.period 250",
                                            "2 devices.8.output.2.period 250"});
  tell(1, "devices.7.status", "left silence 9.000000");
  tell(1, "devices.7.status", "?");
  CHECK(asked().empty());
  tell(1, "devices.7.status", "listed 12.000000"); // it has forgotten
  CHECK(asked().size() == 1);
}

TEST_CASE("a collector watches its keys with any owner and keeps the newest of each tuple",
          "[actors][collector]") {
  fixture world;
  fake<peis_peer_actor> peer(world);
  fake<ecology_actor> ecology(world);
  const std::vector<std::string> keys{"*.*.temperature", "*.presence"};
  const auto app =
      hosted(world, peer, ecology, "collector", std::make_shared<proxy::collector>(keys, 0ns));
  REQUIRE(peer.count<watch_tuples>() == 2);
  CHECK(watch_on(peer, "*.*.temperature").owner == any_peer);
  CHECK(watch_on(peer, "*.presence").owner == any_peer);
  const auto set = [&](int owner, const char* key, bool deleted) {
    world.send(app, tuple_event{0, peer_id{owner}, key, text_value("1"), deleted});
  };
  set(1, "a.b.temperature", false);
  set(1, "a.b.temperature", false);
  set(2, "a.b.temperature", false); // the same key of another owner is another tuple
  set(1, "c.d.temperature", false);
  set(1, "c.d.temperature", true);
  world.send(app, status_request{});
  const auto reported = ecology.all<program_status>().at(0).program;
  CHECK(reported.who == "robot");
  CHECK(reported.figures ==
        std::vector<std::pair<std::string, double>>{{"updates", 5}, {"tuples", 2}});
}

TEST_CASE("a rule points a meta tuple, and again when its owner has been away",
          "[actors][rules][META-05]") {
  fixture world;
  fake<peis_peer_actor> peer{world};
  fake<ecology_actor> ecology{world};
  proxy::rule rule;
  rule.when = "home.mode";
  rule.equals = {"night"};
  rule.writes = {{"lamp.mi-switch", "(META 7 night.light)", "(META -1 NULL)", true},
                 {"fan.switch", "on", "off"}};
  const auto rules = hosted(world, peer, ecology, "rules",
                            std::make_shared<proxy::rules_component>(proxy::rules({rule})));
  const auto owner_is = [&](const std::string& key, bool gone) {
    const auto watch = watch_on(peer, key);
    world.send(rules, tuple_event{watch.watch, fan_owner, key, text_value("x"), gone});
  };
  set_watched(world, peer, "home.mode", text_value("night"));
  CHECK(peer.count<set_meta_tuple>() == 0); // nobody has it yet
  owner_is("lamp.mi-switch", false);
  owner_is("fan.switch", false);
  REQUIRE(peer.count<set_meta_tuple>() == 1);
  const auto first = peer.all<set_meta_tuple>()[0];
  CHECK(first.owner == fan_owner);
  CHECK(first.key == "lamp.mi-switch");
  CHECK(first.reference == "(META 7 night.light)");
  REQUIRE(peer.count<set_remote_tuple>() == 1);
  world.send(rules, peis_outcome{peer.all<set_remote_tuple>()[0].token, true, ""});
  world.run_for(1min);               // so long its owner has had it
  owner_is("lamp.mi-switch", false); // its own write comes back
  CHECK(peer.count<set_meta_tuple>() == 1);
  for (const auto gone : {true, false}) {
    owner_is("lamp.mi-switch", gone);
    owner_is("fan.switch", gone);
  }
  CHECK(peer.count<set_meta_tuple>() == 2);
  CHECK(peer.count<set_remote_tuple>() == 1); // a word is said once
  set_watched(world, peer, "home.mode", text_value("day"));
  CHECK(peer.all<set_meta_tuple>().back().reference == "(META -1 NULL)");
}
