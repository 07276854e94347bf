#include "actors/peis/init.hpp"

#include "actors/kitchen.hpp"
#include "actors/peis/peis_peer.hpp"
#include "support/catch.hpp"
#include "testkit/fake.hpp"

using namespace rubicon;
using test::fake;
using test::fixture;
using test::text;

namespace {

peisinit::component rules() {
  peisinit::component x;
  x.name = "rules";
  x.id = peer_id{41};
  x.peer = "care-rules";
  return x;
}

/// An init whose kernel and ecology are fakes, with one component.
struct init_fixture {
  fixture world;
  fake<peis_peer_actor> kernel{world};
  fake<ecology_actor> ecology{world};
  init_actor aut;

  init_fixture() {
    init_arguments x;
    x.name = "care-init";
    x.id = peer_id{40};
    x.components = {rules()};
    x.peer = kernel.handle();
    x.ecology = ecology.handle();
    aut = world.spawn_at("init/care-init", init_behavior, std::move(x));
  }

  void guard() { world.send(aut, kernel_guarded{"care-pc", "home", 0}); }

  void write(std::string_view word) {
    world.send(aut, tuple_event{0, peer_id{40}, "components.rules.reqState", text(word), false});
  }

  /// Values that a tuple was given.
  [[nodiscard]] std::vector<std::string> values(const std::string& key) const {
    std::vector<std::string> found;
    for (const auto& x : kernel.all<set_tuple>()) {
      if (x.key == key)
        found.push_back(to_string(x.value.view()));
    }
    return found;
  }
};

} // namespace

TEST_CASE("an init guards its kernel before it starts anything",
          "[actors][peisinit][SVC-01][ACT-01]") {
  init_fixture x;
  CHECK(x.kernel.count<guard_kernel>() == 1);
  CHECK(x.kernel.count<set_tuple>() == 0);
  CHECK(x.ecology.count<start_component>() == 0);
  x.guard();
  REQUIRE(x.ecology.count<start_component>() == 1);
  CHECK(x.ecology.all<start_component>()[0].peer == "care-rules");
  CHECK(x.values("components") == std::vector<std::string>{"(rules)"});
  CHECK(x.values("components.rules.exec") == std::vector<std::string>{"peer care-rules"});
  const auto watches = x.kernel.all<watch_tuples>();
  REQUIRE(watches.size() == 3);
  CHECK(watches[0].owner == peer_id{40});
  CHECK(watches[0].key == "components.rules.reqState");
  CHECK(watches[1].key == "components.rules.stdin");
  CHECK(watches[2].key == "components.rules.extra-arguments");
  x.world.send(x.aut, component_started{"care-rules", 1});
  CHECK(x.values("components.rules.currState") ==
        std::vector<std::string>{"off", "starting", "on"});
}

TEST_CASE("an init writes at the component's kernel, and then asks the ecology",
          "[actors][peisinit][SVC-05]") {
  init_fixture x;
  x.guard();
  x.world.send(x.aut, component_started{"care-rules", 1});
  x.write("on"); // as its own tuple is told
  x.write("off");
  const auto first = x.kernel.all<set_remote_tuple>();
  REQUIRE(first.size() == 1);
  CHECK(first[0].owner == peer_id{41});
  CHECK(first[0].key == "do-quit");
  CHECK(first[0].value == text("yes"));
  x.world.run_for(500ms);
  REQUIRE(x.kernel.count<set_remote_tuple>() == 2);
  CHECK(x.kernel.all<set_remote_tuple>()[1].key == "kernel.do-quit");
  CHECK(x.ecology.count<stop_component>() == 0);
  x.world.run_for(500ms);
  x.world.run_for(500ms);
  REQUIRE(x.ecology.count<stop_component>() == 2);
  CHECK_FALSE(x.ecology.all<stop_component>()[1].at_once);
  x.world.run_for(500ms);
  REQUIRE(x.ecology.count<stop_component>() == 3);
  CHECK(x.ecology.all<stop_component>()[2].at_once);
  x.world.send(x.aut, component_ended{"care-rules", 1});
  CHECK(x.values("components.rules.currState").back() == "off");
  x.world.run_for(1min);
  CHECK(x.ecology.count<stop_component>() == 3);
}

TEST_CASE("a component that has ended is started again by its init", "[actors][peisinit][SVC-04]") {
  init_fixture x;
  x.guard();
  x.world.send(x.aut, component_started{"care-rules", 1});
  x.world.send(x.aut, component_ended{"care-rules", 1});
  x.world.run_for(2999ms);
  CHECK(x.ecology.count<start_component>() == 1);
  x.world.run_for(1ms);
  REQUIRE(x.ecology.count<start_component>() == 2);
  CHECK(x.ecology.all<start_component>()[1].life == 2);
}

TEST_CASE("a guarded kernel ends when all components are off", "[actors][peisinit][SVC-01]") {
  init_fixture x;
  x.world.send(x.aut, quit_wanted{}); // before anything has started
  CHECK(x.kernel.count<quit_peer>() == 0);
  x.guard();
  x.world.send(x.aut, component_ended{"care-rules", 1});
  CHECK(x.kernel.count<quit_peer>() == 1);
}

TEST_CASE("a guarded peer asks its init before it ends", "[actors][peis_peer][SVC-01][TUP-22]") {
  fixture world;
  fake<ecology_actor> ecology(world);
  fake<peis_client_actor> client(world);
  fake<init_actor> init(world);
  const auto spawn = [&](peer_id id, const std::string& name) {
    peis_peer_arguments x;
    x.config.network.id = id;
    x.config.network.name = name;
    x.config.network.host_name = "care-pc";
    x.config.network.network = "home";
    x.name = name;
    x.ecology = ecology.handle();
    return world.spawn_at("peis_peer/" + name, peis_peer, std::move(x));
  };
  const auto guarded = spawn(peer_id{40}, "care-init");
  const auto other = spawn(peer_id{41}, "care-rules");
  world.send(guarded, link_opened{1, {other}, false});
  world.send(other, link_opened{1, {guarded}, true});
  world.send(guarded, guard_kernel{init});
  REQUIRE(init.count<kernel_guarded>() == 1);
  CHECK(init.all<kernel_guarded>()[0].host_name == "care-pc");
  CHECK(init.all<kernel_guarded>()[0].network == "home");
  CHECK(init.all<kernel_guarded>()[0].port == 0);
  world.run_for(5s);
  const auto write = set_remote_tuple{client, 1, peer_id{40}, "kernel.do-quit", text("yes"), true};
  world.send(other, write);
  world.run_for(2s);
  CHECK(init.count<quit_wanted>() == 1);
  world.send(guarded, leave_network{});
  CHECK(init.count<quit_wanted>() == 2);
  CHECK(world.ends().empty());
  world.send(guarded, quit_peer{});
  REQUIRE(world.ends().size() == 1);
  CHECK(world.ends()[0].path == "peis_peer/care-init");
  world.send(other, pause_peer{1s}); // a kernel that stands still does not end either
  world.send(other, quit_peer{});
  CHECK(world.ends().size() == 1);
  world.run_for(1s);
  CHECK(world.ends().size() == 2);
}
