#include "actors/kitchen.hpp"
#include "actors/messages/common.hpp"
#include "actors/messages/peis.hpp"
#include "actors/messages/services.hpp"
#include "actors/messages/supervision.hpp"
#include "actors/sample_class.hpp"
#include "actors/services/proxy_manager.hpp"
#include "core/tuples/device_keys.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using test::fake;
using test::fixture;
using test::heater;
using test::kitchen;
using test::set_watched;
using test::text_value;
using test::tuple_at;
using test::watch_on;

namespace {

struct proxy_manager_fixture {
  fixture world;
  fake<peis_peer_actor> peer{world};
  fake<ecology_actor> ecology{world};
  proxy_manager_actor manager;

  /// @param known_from when the manager learns of its only class
  explicit proxy_manager_fixture(instant known_from = {}) {
    proxy_manager_arguments x;
    x.classes = {test::sample_class()};
    x.classes[0].known_from = known_from;
    x.islands = {{kitchen, "kitchen", {{heater.mote, "heater"}}}};
    x.peer_number = peer_id{40};
    x.peer = peer.handle();
    x.ecology = ecology.handle();
    manager = world.spawn_at("proxy_manager/care-pc", proxy_manager, std::move(x));
  }

  void tell(std::string key, payload value, bool deleted = false) {
    world.send(manager, tuple_event{kitchen.value, gateway_of(kitchen), std::move(key),
                                    std::move(value), deleted});
  }
  void list(std::string_view motes) { tell("devices", text_value(motes)); }
  void type(mote_id mote, std::uint32_t type) {
    tell(device_type_key(mote), device_type_octets(type));
  }

  /// How many proxies have ever begun.
  [[nodiscard]] std::size_t started() const { return world.logged("event=started proxy="); }
};

} // namespace

TEST_CASE("a manager watches the list, types and statuses of its islands' gateways",
          "[actors][proxy_manager][PXY-09][ACT-01]") {
  proxy_manager_fixture x;
  REQUIRE(x.peer.count<watch_tuples>() == 3);
  CHECK(watch_on(x.peer, "devices").owner == gateway_of(kitchen));
  CHECK(watch_on(x.peer, "devices.*.type").owner == gateway_of(kitchen));
  CHECK(watch_on(x.peer, "devices.*.status").owner == gateway_of(kitchen));
}

TEST_CASE("list and type, in any order and however often, lead to one proxy",
          "[actors][proxy_manager][PXY-09][PXY-15]") {
  const bool list_first = GENERATE(true, false);
  proxy_manager_fixture x;
  if (list_first)
    x.list("{7}");
  else
    x.type(heater.mote, 301);
  CHECK(x.started() == 0);
  x.list("{7}");
  x.type(heater.mote, 301);
  x.list("{7,11}");
  x.type(heater.mote, 301);
  CHECK(x.started() == 1);
  CHECK(x.world.logged("event=started proxy=kitchen.heater class=heater") == 1);
  CHECK(tuple_at(x.peer, "kitchen.heater.status") == "active");
  CHECK(x.peer.count<watch_tuples>() == 3 + 3);
}

TEST_CASE("a mote that is no longer listed makes its proxy lost until it is back",
          "[actors][proxy_manager][PXY-16]") {
  proxy_manager_fixture x;
  x.list("{7}");
  x.type(heater.mote, 301);
  x.list("{}");
  CHECK(tuple_at(x.peer, "kitchen.heater.status") == "lost");
  CHECK(tuple_at(x.peer, "kitchen.heater.status.cause") == "not_listed");
  x.list("{7}");
  CHECK(tuple_at(x.peer, "kitchen.heater.status") == "active");
  x.tell("devices", {}, true);
  CHECK(tuple_at(x.peer, "kitchen.heater.status") == "lost");
  CHECK(tuple_at(x.peer, "kitchen.heater.status.cause") == "gateway_gone");
  CHECK(x.started() == 1);
}

TEST_CASE("a mote of a type that no class claims gets no proxy, and an event",
          "[actors][proxy_manager][PXY-10]") {
  proxy_manager_fixture x;
  x.list("{7}");
  x.type(heater.mote, 9);
  x.type(heater.mote, 9);
  CHECK(x.started() == 0);
  REQUIRE(x.ecology.count<notable_event>() == 1);
  CHECK(x.ecology.all<notable_event>()[0].what ==
        "mote 5/7 is of type 9, which no proxy class claims");
}

TEST_CASE("a mote gets its proxy when its class becomes known", "[actors][proxy_manager][PXY-10]") {
  proxy_manager_fixture x(instant(10s));
  x.list("{7}");
  x.type(heater.mote, 301);
  x.world.run_for(9s);
  CHECK(x.started() == 0);
  CHECK(x.ecology.count<notable_event>() == 1);
  x.world.run_for(1s);
  CHECK(x.started() == 1);
  CHECK(tuple_at(x.peer, "kitchen.heater.status") == "active");
}

TEST_CASE("a proxy that fails is started again and works", "[actors][proxy_manager][ACT-03]") {
  proxy_manager_fixture x;
  x.list("{7}");
  x.type(heater.mote, 301);
  const auto failing = watch_on(x.peer, "devices.7.output.1").client;
  // A watch that it never asked for: its handler throws.
  x.world.send(failing, tuple_event{0, peer_id{1}, "devices", {}, false});
  CHECK(x.world.logged("proxy_ended mote=5/7") == 1);
  x.world.run_for(999ms);
  CHECK(x.started() == 1); // not at once: a proxy that fails at birth must not stop time
  x.world.run_for(1ms);
  CHECK(x.started() == 2);
  CHECK(watch_on(x.peer, "devices.7.output.1").client != failing);
  set_watched(x.world, x.peer, "devices.7.output.1", bytes{0x00, 0xdf});
  CHECK(tuple_at(x.peer, "kitchen.heater.temperature") == "22.3");
  x.list("{}");
  CHECK(tuple_at(x.peer, "kitchen.heater.status") == "lost");
  CHECK(x.world.ends().empty()); // the manager goes on
}

TEST_CASE("a proxy that fails while its mote is away is started when the mote is back",
          "[actors][proxy_manager][ACT-03]") {
  proxy_manager_fixture x;
  x.list("{7}");
  x.type(heater.mote, 301);
  x.list("{}");
  post_exit(watch_on(x.peer, "devices.7.output.1").client, caf::exit_reason::kill);
  x.world.run_for(0s);
  CHECK(x.started() == 1);
  x.list("{7}");
  x.world.run_for(1s);
  CHECK(x.started() == 2);
  CHECK(tuple_at(x.peer, "kitchen.heater.status") == "active");
}

TEST_CASE("a mote that comes back as another kind loses its proxy",
          "[actors][proxy_manager][PXY-09]") {
  proxy_manager_fixture x;
  x.list("{7}");
  x.type(heater.mote, 301);
  x.type(heater.mote, 9);
  x.world.send(x.manager, status_request{});
  CHECK(x.ecology.count<proxy_status>() == 1); // of the one that has ended
  CHECK(x.started() == 1);
  CHECK(x.world.logged("proxy_ended") == 0); // it was stopped, it did not fail
}

TEST_CASE("a manager passes a status request on to its proxies", "[actors][proxy_manager]") {
  proxy_manager_fixture x;
  x.list("{7,11}");
  x.type(heater.mote, 301);
  x.type(mote_id{11}, 302);
  x.world.send(x.manager, status_request{});
  REQUIRE(x.ecology.count<proxy_status>() == 2);
  CHECK(x.ecology.all<proxy_status>()[0].proxy.name == "kitchen.heater");
  CHECK(x.ecology.all<proxy_status>()[1].proxy.name == "kitchen.11");
}
