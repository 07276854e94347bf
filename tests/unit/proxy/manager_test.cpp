#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/numbers/random.hpp"
#include "core/tuples/device_keys.hpp"
#include "proxy/manager.hpp"
#include "support/catch.hpp"
#include "unit/proxy/fixture.hpp"

using namespace rubicon;
using namespace rubicon::proxy;
using test::claims;

namespace {

constexpr island_id kitchen{5};
constexpr island_id hall{6};
constexpr instant now{};

class_table sensors_and_lamps() {
  return class_table({claims("sensor", {{100, 199}}), claims("lamp", {{142, 142}})});
}

using lines = std::vector<std::string>;

lines lines_of(const manager::outputs& outputs) {
  struct formatter {
    std::string operator()(const start_proxy& x) const {
      return "start " + to_string(x.mote) + ' ' + x.class_name;
    }
    std::string operator()(const stop_proxy& x) const { return "stop " + to_string(x.mote); }
    std::string operator()(const set_presence& x) const {
      const auto mote = to_string(x.mote);
      if (x.presence == device_presence::left)
        return "gone " + mote + ' ' + x.cause;
      return (x.presence == device_presence::stale ? "stale " : "there ") + mote;
    }
    std::string operator()(const unknown_type& x) const {
      return "unknown " + to_string(x.mote) + ' ' + std::to_string(x.type);
    }
  };
  lines list;
  for (const auto& x : outputs)
    list.push_back(std::visit(formatter{}, x));
  return list;
}

struct text_manager {
  manager aut{sensors_and_lamps()};

  lines devices(std::string_view text, island_id island = kitchen) {
    return lines_of(aut.on_devices(island, text, now));
  }
  lines type(int mote, std::uint32_t type, island_id island = kitchen) {
    return lines_of(aut.on_type(island, mote_id{static_cast<std::uint16_t>(mote)},
                                device_type_octets(type), now));
  }
};

} // namespace

TEST_CASE("a new mote leads to one proxy and repeated percepts to none",
          "[proxy][PXY-09][PXY-13]") {
  text_manager x;
  SECTION("list first") {
    CHECK(x.devices("{7}").empty());
    CHECK(x.type(7, 100) == lines{"start 5/7 sensor"});
  }
  SECTION("type first") {
    CHECK(x.type(7, 100).empty());
    CHECK(x.devices("{7}") == lines{"start 5/7 sensor"});
  }
  for (int i = 0; i < 3; ++i) {
    CHECK(x.devices("{7}").empty());
    CHECK(x.type(7, 100).empty());
  }
  CHECK(x.aut.running() == 1);
  CHECK(x.aut.running_class({kitchen, mote_id{7}}) == "sensor");
  CHECK(x.aut.counters().started == 1);
}

TEST_CASE("each mote has a proxy of its own, also with equal ids in two islands",
          "[proxy][PXY-08][PXY-15]") {
  text_manager x;
  CHECK(x.devices("{1,7}").empty());
  CHECK(x.devices("{7}", hall).empty());
  CHECK(x.type(7, 142) == lines{"start 5/7 lamp"});
  CHECK(x.type(1, 142) == lines{"start 5/1 lamp"});
  CHECK(x.type(7, 101, hall) == lines{"start 6/7 sensor"});
  CHECK(x.devices("{}") == lines{"gone 5/1 not_listed", "gone 5/7 not_listed"});
  CHECK(x.aut.running() == 3);
}

TEST_CASE("a proxy is notified when its mote goes and returns", "[proxy][PXY-15][PXY-16]") {
  text_manager x;
  x.devices("{1,7}");
  x.type(1, 100);
  x.type(7, 100);
  for (int i = 0; i < 10; ++i) {
    CHECK(x.devices("{1}") == lines{"gone 5/7 not_listed"});
    CHECK(x.devices("{1}").empty());
    CHECK(x.devices("{1,7}") == lines{"there 5/7"});
    CHECK(x.type(7, 100).empty());
  }
  CHECK(x.aut.counters().started == 2);
}

TEST_CASE("when a gateway goes all its motes are gone", "[proxy][PXY-14][PXY-16]") {
  text_manager x;
  x.devices("{1,7}");
  x.type(1, 100);
  x.type(7, 5); // no proxy
  x.devices("{1}", hall);
  x.type(1, 100, hall);
  CHECK(lines_of(x.aut.on_gateway_gone(kitchen, now)) == lines{"gone 5/1 gateway_gone"});
  CHECK(lines_of(x.aut.on_gateway_gone(kitchen, now)).empty());
  CHECK(lines_of(x.aut.on_gateway_gone(island_id{9}, now)).empty());
  CHECK(x.devices("{1,7}") == lines{"there 5/1"});
}

TEST_CASE("a mote that becomes another kind gets another proxy", "[proxy][PXY-13][DIS-07]") {
  text_manager x;
  x.devices("{7}");
  x.type(7, 100);
  CHECK(x.type(7, 142) == lines{"stop 5/7", "start 5/7 lamp"});
  CHECK(x.type(7, 5) == lines{"stop 5/7", "unknown 5/7 5"});
  CHECK(x.aut.running() == 0);
  CHECK(x.type(7, 101) == lines{"start 5/7 sensor"});
  CHECK(x.type(7, 102).empty()); // another type of the same class
  SECTION("while it was away") {
    CHECK(x.devices("{}") == lines{"gone 5/7 not_listed"});
    CHECK(x.type(7, 142).empty());
    CHECK(x.devices("{7}") == lines{"stop 5/7", "start 5/7 lamp"});
  }
  SECTION("and is listed again before its type is known") {
    x.devices("{}");
    CHECK(x.devices("{7}") == lines{"there 5/7"});
    CHECK(x.type(7, 142) == lines{"stop 5/7", "start 5/7 lamp"});
  }
}

TEST_CASE("an unknown type is reported once and tried again with other classes",
          "[proxy][PXY-10]") {
  text_manager x;
  CHECK(x.type(7, 300).empty());
  CHECK(x.devices("{7}") == lines{"unknown 5/7 300"});
  CHECK(x.type(7, 300).empty());
  CHECK(x.devices("{7}").empty());
  CHECK(x.devices("{}").empty()); // there is no proxy to notify
  CHECK(x.devices("{7}").empty());
  CHECK(lines_of(x.aut.on_classes(sensors_and_lamps(), now)).empty());
  CHECK(x.type(7, 301) == lines{"unknown 5/7 301"});
  CHECK(lines_of(x.aut.on_classes(class_table({claims("new", {{300, 310}})}), now)) ==
        lines{"start 5/7 new"});
}

TEST_CASE("other classes do not touch running proxies", "[proxy][PXY-10][PXY-15]") {
  text_manager x;
  x.devices("{7,8}");
  x.type(7, 142);
  CHECK(lines_of(x.aut.on_classes(class_table({claims("new", {{142, 142}})}), now)).empty());
  CHECK(x.aut.running_class({kitchen, mote_id{7}}) == "lamp");
  CHECK(x.type(8, 142) == lines{"start 5/8 new"});
}

TEST_CASE("an absent mote is not started when its class arrives", "[proxy][PXY-10]") {
  text_manager x;
  x.devices("{7}");
  x.type(7, 300);
  x.devices("{}");
  CHECK(lines_of(x.aut.on_classes(class_table({claims("new", {{300, 300}})}), now)).empty());
  CHECK(x.devices("{7}") == lines{"start 5/7 new"});
}

TEST_CASE("a proxy that ended by itself is started again with its mote", "[proxy][PXY-20]") {
  text_manager x;
  x.devices("{7}");
  x.type(7, 100);
  CHECK(lines_of(x.aut.on_proxy_gone({kitchen, mote_id{7}}, now)) == lines{"start 5/7 sensor"});
  x.devices("{}");
  CHECK(lines_of(x.aut.on_proxy_gone({kitchen, mote_id{7}}, now)).empty());
  CHECK(lines_of(x.aut.on_proxy_gone({kitchen, mote_id{7}}, now)).empty());
  CHECK(lines_of(x.aut.on_proxy_gone({kitchen, mote_id{9}}, now)).empty());
  CHECK(x.aut.running() == 0);
  CHECK(x.devices("{7}") == lines{"start 5/7 sensor"});
}

TEST_CASE("malformed percepts are counted and change nothing", "[proxy][GW-03][GW-04]") {
  text_manager x;
  x.devices("{7}");
  x.type(7, 100);
  for (const auto* const text : {"", "7", "{7,7}", "{8,7}", "{65533}", "{7"})
    CHECK(x.devices(text).empty());
  CHECK(x.aut.counters().bad_lists == 6);
  for (const auto& octets : {bytes{}, bytes{0, 0, 142}, bytes{0, 0, 0, 0, 142}})
    CHECK(x.aut.on_type(kitchen, mote_id{7}, octets, now).empty());
  CHECK(x.aut.on_type(kitchen, mote_id{0}, device_type_octets(100), now).empty()); // a stranger
  CHECK(x.aut.on_type(kitchen, broadcast_mote, device_type_octets(100), now).empty());
  CHECK(x.aut.counters().bad_types == 4);
  CHECK(x.devices("{7}").empty());
}

TEST_CASE("tuples of a gateway are routed by their keys", "[proxy][PXY-14][PXY-19]") {
  text_manager x;
  const bytes list{'{', '7', '}', 0};
  CHECK(x.aut.on_gateway_tuple(kitchen, "devices", list, now).empty());
  CHECK(lines_of(x.aut.on_gateway_tuple(kitchen, "Devices.7.type", device_type_octets(142), now)) ==
        lines{"start 5/7 lamp"});
  CHECK(x.aut.on_gateway_tuple(kitchen, "devices.7.output.1", bytes{1}, now).empty());
  CHECK(x.aut.on_gateway_tuple(kitchen, "kernel.name", bytes{1}, now).empty());
  CHECK(x.aut.counters().foreign_tuples == 2);
}

TEST_CASE("a manager knows a bounded number of motes", "[proxy]") {
  manager aut(sensors_and_lamps(), 2);
  CHECK(aut.on_devices(kitchen, "{1,2,3}", now).empty());
  CHECK(aut.counters().motes_refused == 1);
  CHECK(lines_of(aut.on_type(kitchen, mote_id{2}, device_type_octets(100), now)) ==
        lines{"start 5/2 sensor"});
  CHECK(aut.on_type(kitchen, mote_id{3}, device_type_octets(100), now).empty());
  CHECK(aut.counters().motes_refused == 2);
}

TEST_CASE("proxies hear when a mote is stale, and why it has left",
          "[proxy][PXY-16][GW-15][IF-13]") {
  text_manager x;
  const auto status = [&](std::string_view text) {
    return lines_of(x.aut.on_status(kitchen, mote_id{7}, text, now));
  };
  CHECK(status("listed 1.000000").empty());
  CHECK(x.type(7, 100).empty());
  CHECK(x.devices("{7}") == lines{"start 5/7 sensor"});
  CHECK(status("stale 2.000000") == lines{"stale 5/7"});
  CHECK(status("stale 2.000000").empty());
  CHECK(status("listed 3.000000") == lines{"there 5/7"});
  SECTION("cause first") {
    CHECK(status("left battery 4.000000").empty());
    CHECK(x.devices("{}") == lines{"gone 5/7 battery"});
  }
  SECTION("list first") {
    CHECK(x.devices("{}") == lines{"gone 5/7 not_listed"});
    CHECK(status("left battery 4.000000") == lines{"gone 5/7 battery"});
  }
  CHECK(status("listed 5.000000").empty());
  CHECK(x.devices("{7}") == lines{"there 5/7"});
  CHECK(status("what").empty());
  CHECK(x.aut.counters().bad_statuses == 1);
}

TEST_CASE("whatever the order of percepts, proxies match the motes that are there",
          "[proxy][PXY-09][PXY-16]") {
  const auto seed = GENERATE(range(1, 11));
  random_stream rng(static_cast<std::uint64_t>(seed));
  manager aut(sensors_and_lamps());
  std::map<mote_address, std::string> running; // class of each proxy
  std::map<mote_address, bool> believes;
  const auto carry_out = [&](const manager::outputs& outputs) {
    for (const auto& x : outputs) {
      if (const auto* const start = std::get_if<start_proxy>(&x)) {
        REQUIRE(running.emplace(start->mote, start->class_name).second);
        believes[start->mote] = true;
      } else if (const auto* const stop = std::get_if<stop_proxy>(&x)) {
        REQUIRE(running.erase(stop->mote) == 1);
        believes.erase(stop->mote);
      } else if (const auto* const change = std::get_if<set_presence>(&x)) {
        const bool is_there = change->presence != device_presence::left;
        REQUIRE(std::exchange(believes.at(change->mote), is_there) != is_there);
      }
    }
  };
  std::set<mote_id> listed;
  std::map<mote_id, std::uint32_t> types;
  for (int step = 0; step < 2000; ++step) {
    const mote_id mote{static_cast<std::uint16_t>(1 + rng.below(5))};
    switch (rng.below(4)) {
    case 0:
      listed.insert(mote);
      break;
    case 1:
      listed.erase(mote);
      break;
    case 2:
      types[mote] = std::vector<std::uint32_t>{100, 142, 7}[rng.below(3)];
      carry_out(aut.on_type(kitchen, mote, device_type_octets(types[mote]), now));
      break;
    default:
      if (rng.chance(0.1)) {
        listed.clear();
        carry_out(aut.on_gateway_gone(kitchen, now));
      }
      break;
    }
    carry_out(aut.on_devices(kitchen, device_list_text({listed.begin(), listed.end()}), now));
    for (const auto id : listed) {
      const mote_address address{kitchen, id};
      const bool claimed = types.count(id) == 1 && types[id] != 7;
      REQUIRE((running.count(address) == 1) == claimed);
      if (claimed) {
        REQUIRE(running.at(address) == (types[id] == 142 ? "lamp" : "sensor"));
        REQUIRE(believes.at(address));
      }
    }
    for (const auto& [address, present] : believes)
      REQUIRE(present == (listed.count(address.mote) == 1));
  }
}
