#include "actors/kitchen.hpp"
#include "actors/messages/common.hpp"
#include "actors/messages/peis.hpp"
#include "actors/messages/services.hpp"
#include "actors/messages/supervision.hpp"
#include "actors/sample_class.hpp"
#include "actors/services/proxy.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using test::fake;
using test::fixture;
using test::heater;
using test::set_watched;
using test::text_value;
using test::tuple_at;
using test::watch_on;

namespace {

constexpr peer_id care_pc{40};

struct proxy_fixture {
  fixture world;
  fake<peis_peer_actor> peer{world};
  fake<ecology_actor> ecology{world};
  proxy_actor proxy;

  proxy_fixture() {
    proxy::proxy core(test::sample_class(), {heater, "kitchen", "heater"});
    proxy =
        world.spawn_at("proxy/kitchen.heater", proxy_behavior,
                       proxy_arguments{std::move(core), care_pc, peer.handle(), ecology.handle()});
  }

  void ask(std::string_view word) {
    set_watched(world, peer, "kitchen.heater.switch", text_value(word));
  }

  void answer(std::string_view status) {
    set_watched(world, peer, "devices.7.input.2.status", text_value(status));
  }

  [[nodiscard]] std::string outcome() const {
    return tuple_at(peer, "kitchen.heater.switch.outcome");
  }
};

} // namespace

TEST_CASE("a proxy says what it is and watches its gateway and its own input",
          "[actors][proxy][PXY-14][ACT-01]") {
  proxy_fixture x;
  CHECK(tuple_at(x.peer, "kitchen.heater.status") == "active");
  CHECK(tuple_at(x.peer, "kitchen.heater.class") == "heater");
  CHECK(tuple_at(x.peer, "kitchen.heater.id") == "5/7");
  CHECK(tuple_at(x.peer, "kitchen.heater.description") == "a heater");
  CHECK(tuple_at(x.peer, "kitchen.heater.switch") == "none");
  CHECK(watch_on(x.peer, "devices.7.output.1").owner == gateway_of(heater.island));
  CHECK(watch_on(x.peer, "devices.7.input.2.status").owner == gateway_of(heater.island));
  CHECK(watch_on(x.peer, "kitchen.heater.switch").owner == care_pc);
  CHECK(x.peer.count<watch_tuples>() == 3);
}

TEST_CASE("a reading becomes a readable tuple, also when it is the same again",
          "[actors][proxy][PXY-04]") {
  proxy_fixture x;
  set_watched(x.world, x.peer, "devices.7.output.1", bytes{0x00, 0xdf});
  CHECK(tuple_at(x.peer, "kitchen.heater.temperature") == "22.3");
  CHECK(tuple_at(x.peer, "kitchen.heater.temperature.unit") == "C");
  const auto before = x.peer.count<set_tuple>();
  set_watched(x.world, x.peer, "devices.7.output.1", bytes{0x00, 0xdf});
  CHECK(x.peer.count<set_tuple>() == before + 1);
  set_watched(x.world, x.peer, "devices.7.output.1", bytes{0xff, 0x9c});
  CHECK(tuple_at(x.peer, "kitchen.heater.temperature") == "-10.0");
  set_watched(x.world, x.peer, "devices.7.output.1", bytes{0x01}); // too short
  CHECK(tuple_at(x.peer, "kitchen.heater.temperature") == "-10.0");
}

TEST_CASE("a word becomes octets at the gateway, and its answer an outcome",
          "[actors][proxy][PXY-12]") {
  proxy_fixture x;
  x.ask("on");
  const auto writes = x.peer.all<set_remote_tuple>();
  REQUIRE(writes.size() == 1);
  CHECK(writes[0].owner == gateway_of(heater.island));
  CHECK(writes[0].key == "devices.7.input.2");
  CHECK(writes[0].value == payload(bytes{0x01}));
  CHECK(!writes[0].text);
  x.answer("1 pending");
  CHECK(x.outcome() == "nothing");
  x.answer("1 acknowledged");
  CHECK(x.outcome() == "on acknowledged");
  x.ask("off");
  x.answer("2 pending");
  x.answer("2 failed");
  CHECK(x.outcome() == "off failed");
}

TEST_CASE("a word that the input does not know is refused, and a deleted tuple asks for nothing",
          "[actors][proxy][PXY-12]") {
  proxy_fixture x;
  x.ask("sideways");
  CHECK(x.outcome() == "sideways refused");
  const auto watch = watch_on(x.peer, "kitchen.heater.switch");
  x.world.send(x.proxy, tuple_event{watch.watch, care_pc, watch.key, text_value("on"), true});
  CHECK(x.peer.count<set_remote_tuple>() == 0);
}

TEST_CASE("a request that nobody answers ends in a timeout", "[actors][proxy][PXY-12]") {
  proxy_fixture x;
  x.ask("on");
  x.world.send(x.proxy, peis_outcome{0, false, "no_route"});
  CHECK(x.world.logged("write_failed cause=no_route") == 1);
  x.world.run_for(20s - 1ns);
  CHECK(x.outcome() == "nothing");
  x.world.run_for(1ns);
  CHECK(x.outcome() == "on timeout");
}

TEST_CASE("a proxy whose mote has gone is lost, and active again when it is back",
          "[actors][proxy][PXY-16][PXY-20]") {
  proxy_fixture x;
  x.world.send(x.proxy, mote_presence{device_presence::left, "battery"});
  CHECK(tuple_at(x.peer, "kitchen.heater.status") == "lost");
  CHECK(tuple_at(x.peer, "kitchen.heater.status.cause") == "battery");
  x.ask("on");
  CHECK(x.outcome() == "on unreachable");
  CHECK(x.peer.count<set_remote_tuple>() == 0);
  x.world.send(x.proxy, mote_presence{});
  CHECK(tuple_at(x.peer, "kitchen.heater.status") == "active");
  CHECK(tuple_at(x.peer, "kitchen.heater.status.cause") == "none");
}

TEST_CASE("a proxy reports its status, values and actuations", "[actors][proxy]") {
  proxy_fixture x;
  set_watched(x.world, x.peer, "devices.7.output.1", bytes{0x00, 0xdf});
  x.ask("on");
  x.answer("1 pending");
  x.answer("1 acknowledged");
  x.ask("sideways");
  x.world.send(x.proxy, status_request{});
  REQUIRE(x.ecology.count<proxy_status>() == 1);
  const auto report = x.ecology.all<proxy_status>()[0].proxy;
  CHECK(report.name == "kitchen.heater");
  CHECK(report.proxy_class == "heater");
  CHECK(report.status == "active");
  CHECK(report.values ==
        std::vector<std::pair<std::string, std::string>>{{"temperature", "22.3 C"}});
  CHECK(report.actuations.requested == 2);
  CHECK(report.actuations.acknowledged == 1);
  CHECK(report.actuations.failed == report::cause_counts{{"refused", 1}});
}

TEST_CASE("an input that may be any tuple is declared and followed by its meta tuple",
          "[actors][proxy][PXY-12][META-05]") {
  fixture world;
  fake<peis_peer_actor> peer{world};
  fake<ecology_actor> ecology{world};
  auto what = test::sample_class();
  what.inputs[0].meta = true;
  world.spawn_at("proxy/kitchen.heater", proxy_behavior,
                 proxy_arguments{proxy::proxy(what, {heater, "kitchen", "heater"}), care_pc,
                                 peer.handle(), ecology.handle()});
  const auto declared = peer.all<declare_meta_tuple>();
  REQUIRE(declared.size() == 1);
  CHECK(declared[0].key == "kitchen.heater.mi-switch");
  CHECK(declared[0].reference == "(META 40 kitchen.heater.switch)");
  const auto followed = peer.all<watch_indirectly>();
  REQUIRE(followed.size() == 1);
  CHECK(followed[0].owner == care_pc);
  CHECK(followed[0].key == "kitchen.heater.mi-switch");
  CHECK(peer.count<watch_tuples>() == 2); // of the gateway alone
  // A word of another owner's tuple, which the kernel follows at the time.
  world.send(followed[0].client,
             tuple_event{followed[0].watch, peer_id{7}, "wall.light", text_value("on"), false});
  REQUIRE(peer.count<set_remote_tuple>() == 1);
  CHECK(peer.all<set_remote_tuple>()[0].value == payload(bytes{0x01}));
}
