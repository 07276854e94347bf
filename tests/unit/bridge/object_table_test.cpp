#include <string>

#include "bridge/table/object_table.hpp"
#include "support/catch.hpp"
#include "unit/bridge/classes.hpp"

using namespace rubicon;
using namespace rubicon::bridge;
using test::bridged_classes;
using test::bridged_deletion;
using test::bridged_news;

TEST_CASE("a class's prefix with names in braces is a pattern of keys", "[bridge]") {
  proxy::proxy_class x;
  x.name = "climate";
  x.prefix = "{island}.lamp-{id}.x";
  CHECK(model_of(x).pattern == "*.*.x");
}

TEST_CASE("each key of the classes is watched once", "[bridge]") {
  const auto keys = object_table(bridged_classes()).watched();
  CHECK(keys == std::vector<std::string>{"kitchen.*.class", "kitchen.*.door", "kitchen.*.rssi",
                                         "kitchen.*.speed.outcome", "kitchen.*.status",
                                         "kitchen.*.switch.outcome", "kitchen.*.temperature"});
}

TEST_CASE("an object is there from its class on, with what arrived before", "[bridge]") {
  object_table all(bridged_classes());
  CHECK(all.on_tuple(bridged_news("kitchen.a.temperature", "21.5")).empty());
  CHECK(all.find("kitchen.a") == nullptr);
  const auto changes = all.on_tuple(bridged_news("kitchen.a.class", "climate"));
  REQUIRE(changes.size() == 1);
  CHECK(changes[0].what == change_kind::appeared);
  REQUIRE(all.find("Kitchen.A") != nullptr);
  CHECK(all.find("kitchen.a")->values.at("temperature") == "21.5");
  CHECK(all.on_tuple(bridged_news("kitchen.a.class", "climate")).empty());
}

TEST_CASE("values of other owners than the object's are ignored", "[bridge]") {
  object_table all(bridged_classes());
  static_cast<void>(all.on_tuple(bridged_news("kitchen.a.class", "climate")));
  static_cast<void>(all.on_tuple(bridged_news("kitchen.a.status", "active")));
  CHECK(all.on_tuple(bridged_news("kitchen.a.status", "lost", peer_id{31})).empty());
  CHECK(all.find("kitchen.a")->is_available());
}

TEST_CASE("an input has what was acknowledged last, not what failed", "[bridge]") {
  object_table all(bridged_classes());
  static_cast<void>(all.on_tuple(bridged_news("kitchen.f.class", "fan")));
  static_cast<void>(all.on_tuple(bridged_news("kitchen.f.switch.outcome", "on acknowledged")));
  const auto changes = all.on_tuple(bridged_news("kitchen.f.switch.outcome", "off failed"));
  REQUIRE(changes.size() == 1);
  CHECK(changes[0].what == change_kind::outcome);
  CHECK(changes[0].input == "switch");
  CHECK(all.find("kitchen.f")->inputs.at("switch") == "on");
  CHECK(all.find("kitchen.f")->outcomes.at("switch") == "failed");
}

TEST_CASE("objects beyond the table's room and long values are counted", "[bridge]") {
  object_table all(bridged_classes(), 1);
  static_cast<void>(all.on_tuple(bridged_news("kitchen.a.class", "climate")));
  CHECK(all.on_tuple(bridged_news("kitchen.b.class", "climate")).empty());
  CHECK(all.counters().table_full == 1);
  CHECK(all.on_tuple(bridged_news("kitchen.a.temperature", std::string(256, '1'))).size() == 1);
  CHECK(all.on_tuple(bridged_news("kitchen.a.temperature", std::string(257, '1'))).empty());
  CHECK(all.counters().bad_values == 1);
  CHECK(all.on_tuple(bridged_news("kitchen.+.class", "climate")).empty());
  CHECK(all.counters().bad_names == 1);
  CHECK(all.on_tuple(bridged_deletion("kitchen.a.class")).at(0).what == change_kind::disappeared);
  CHECK(all.all().empty());
}

TEST_CASE("an input accepts its words in any letter case and numbers in its range", "[bridge]") {
  const auto fan = bridged_classes().at(1);
  CHECK(accepted(fan.inputs[0], "ON") == "on");
  CHECK(!accepted(fan.inputs[0], "1"));
  CHECK(accepted(fan.inputs[1], "50.5") == "50.5");
  CHECK(!accepted(fan.inputs[1], "100001"));
  CHECK(!accepted(fan.inputs[1], "nan"));
}

TEST_CASE("an outcome that is deleted is not shown, and nothing stays of an object without class",
          "[bridge]") {
  object_table x(bridged_classes(), 1);
  static_cast<void>(x.on_tuple(bridged_news("kitchen.g.status", "active")));
  static_cast<void>(x.on_tuple(bridged_news("kitchen.f.class", "fan")));
  CHECK(x.counters().table_full == 1);
  static_cast<void>(x.on_tuple(bridged_deletion("kitchen.g.status")));
  static_cast<void>(x.on_tuple(bridged_news("kitchen.f.class", "fan")));
  REQUIRE(x.find("kitchen.f") != nullptr);
  static_cast<void>(x.on_tuple(bridged_news("kitchen.f.switch.outcome", "on acknowledged")));
  CHECK(x.find("kitchen.f")->outcomes.size() == 1);
  static_cast<void>(x.on_tuple(bridged_deletion("kitchen.f.switch.outcome")));
  CHECK(x.find("kitchen.f")->outcomes.empty());
  CHECK(x.find("kitchen.f")->inputs.at("switch") == "on");
}
