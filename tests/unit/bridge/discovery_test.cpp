#include <set>
#include <string>

#include <nlohmann/json.hpp>

#include "bridge/home_assistant/discovery.hpp"
#include "support/catch.hpp"
#include "unit/bridge/classes.hpp"

using namespace rubicon;
using namespace rubicon::bridge;
using test::bridged_classes;

namespace {

const discovery_names usual_names{"rubicon", "homeassistant"};

nlohmann::json document_of(std::size_t model, const platform_table& given = {}) {
  object x;
  x.name = "kitchen.climate-7";
  return nlohmann::json::parse(
      discovery_document(usual_names, bridged_classes().at(model), x, given, x.name));
}

} // namespace

TEST_CASE("a reading is an entity with the class and unit of its quantity", "[bridge]") {
  const auto x = document_of(0);
  CHECK(x["dev"]["name"] == "kitchen.climate-7");
  CHECK(x["avty_mode"] == "all");
  REQUIRE(x["avty"].size() == 2);
  CHECK(x["avty"][0]["t"] == "rubicon/bridge/state");
  CHECK(x["avty"][1]["t"] == "rubicon/kitchen.climate-7/availability");
  CHECK(x["stat_t"] == "rubicon/kitchen.climate-7");
  CHECK(x["o"]["name"] == "rubicon");
  const auto& entity = x["cmps"]["temperature"];
  CHECK(entity["p"] == "sensor");
  CHECK(entity["name"] == "Temperature");
  CHECK(entity["dev_cla"] == "temperature");
  CHECK(entity["unit_of_meas"] == "\u00b0C");
  CHECK(entity["default_entity_id"] == "sensor.rubicon_kitchen_climate_7_temperature");
  CHECK(!entity.contains("object_id"));
  CHECK(x["cmps"]["door"]["p"] == "binary_sensor");
  CHECK(x["cmps"]["door"]["pl_on"] == "open");
  CHECK(x["cmps"]["door"]["dev_cla"] == "opening");
}

TEST_CASE("an input is an entity by its words, or of the platform that is given", "[bridge]") {
  const auto x = document_of(1);
  CHECK(x["cmps"]["switch"]["p"] == "fan"); // of class fan
  CHECK(x["cmps"]["switch"]["cmd_t"] == "rubicon/kitchen.climate-7/set/switch");
  CHECK(x["cmps"]["speed"]["p"] == "number");
  CHECK(x["cmps"]["speed"]["max"] == 100'000);
  CHECK(document_of(1, {{"fan.switch", platform::switch_}})["cmps"]["switch"]["p"] == "switch");
  CHECK(document_of(1, {{"fan.switch", platform::cover}})["cmps"]["switch"]["p"] == "fan");
}

TEST_CASE("platforms follow from words", "[bridge]") {
  const class_model plug{"plug", "*.*", {}, {}};
  CHECK(platform_of(plug, input_model{"relay", "", {"on", "off"}}, {}) == platform::switch_);
  CHECK(platform_of(plug, input_model{"lamp", "", {"on", "off"}}, {}) == platform::light);
  CHECK(platform_of(plug, input_model{"blind", "", {"open", "close"}}, {}) == platform::cover);
  CHECK(platform_of(plug, input_model{"bell", "", {"ring"}}, {}) == platform::button);
  CHECK(platform_of(plug, input_model{"mode", "", {"on", "off", "eco"}}, {}) == platform::select);
}

TEST_CASE("ids of devices differ where names do", "[bridge]") {
  std::set<std::string> ids;
  for (const auto* name : {"a.b", "a_b", "a-b", "a-.b", "a._b", "a_.b", "a-u.b", "a--b"})
    ids.insert(device_id(usual_names, name));
  CHECK(ids.size() == 8);
  CHECK(device_id(usual_names, "Kitchen.fan") == device_id(usual_names, "kitchen.fan"));
}

TEST_CASE("a state is a number where the reading is one, and null before the first", "[bridge]") {
  object x;
  x.values["temperature"] = "21.5";
  const auto all = nlohmann::json::parse(state_document(bridged_classes().at(0), x));
  CHECK(all["temperature"] == 21.5);
  CHECK(all["door"].is_null());
}
