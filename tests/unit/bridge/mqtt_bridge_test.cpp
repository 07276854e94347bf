#include <algorithm>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "bridge/mqtt/mqtt_bridge.hpp"
#include "bridge/mqtt/simulated_broker.hpp"
#include "support/catch.hpp"
#include "support/start.hpp"
#include "unit/bridge/classes.hpp"

using namespace rubicon;
using namespace rubicon::bridge;
using test::bridged_classes;
using test::bridged_news;
using test::start;

namespace {

mqtt_bridge bridge_of(mqtt_config config = {}) {
  return {std::move(config), bridged_classes(), random_stream(1)};
}

struct timed_publication {
  instant at;
  publication what;
};

/// Calls the bridge at its deadlines.
std::vector<timed_publication> run_until(mqtt_bridge& x, instant end) {
  std::vector<timed_publication> out;
  for (auto at = x.deadline(); at && *at <= end; at = x.deadline())
    for (auto& each : x.on_time(*at))
      if (auto* sent = std::get_if<publication>(&each))
        out.push_back({*at, std::move(*sent)});
  return out;
}

std::optional<std::size_t> place_of(const std::vector<timed_publication>& in,
                                    const std::string& topic) {
  const auto found =
      std::ranges::find_if(in, [&topic](const auto& each) { return each.what.topic == topic; });
  return found == in.end() ? std::nullopt
                           : std::optional(static_cast<std::size_t>(found - in.begin()));
}

std::vector<components::write> writes_in(const mqtt_outputs& in) {
  std::vector<components::write> out;
  for (const auto& each : in)
    if (const auto* write = std::get_if<components::write>(&each))
      out.push_back(*write);
  return out;
}

/// With a fan that is active, connected and announced.
mqtt_bridge with_fan(mqtt_config config = {}) {
  auto x = bridge_of(std::move(config));
  static_cast<void>(x.on_connected(start));
  static_cast<void>(x.on_tuple(bridged_news("kitchen.f.class", "fan"), start));
  static_cast<void>(x.on_tuple(bridged_news("kitchen.f.status", "active"), start));
  static_cast<void>(run_until(x, start + 8s));
  return x;
}

} // namespace

TEST_CASE("objects are announced before their states, and the bridge is online last",
          "[bridge][mqtt]") {
  auto x = bridge_of();
  CHECK(x.on_tuple(bridged_news("kitchen.f.class", "fan"), start).empty());
  CHECK(x.on_tuple(bridged_news("kitchen.f.status", "active"), start).empty());
  static_cast<void>(x.on_connected(start));
  const auto sent = run_until(x, start + 4s);
  REQUIRE(sent.size() == 5);
  CHECK(sent[0].what.topic == "homeassistant/device/rubicon-skitchen_f/config");
  CHECK(sent[1].what == publication{"rubicon/kitchen.f/availability", R"({"state":"online"})"});
  CHECK(sent[2].what.topic == "rubicon/kitchen.f");
  CHECK(sent[3].what.topic == "rubicon/bridge/devices");
  CHECK(sent[4].what == publication{"rubicon/bridge/state", R"({"state":"online"})"});
  CHECK(x.last_will() == publication{"rubicon/bridge/state", R"({"state":"offline"})"});
}

TEST_CASE("a command is written once and changes the state when it is acknowledged",
          "[bridge][mqtt]") {
  auto x = with_fan();
  const auto now = start + 10s;
  const auto writes = writes_in(x.on_message({"rubicon/kitchen.f/set", R"({"switch":"ON"})"}, now));
  REQUIRE(writes.size() == 1);
  CHECK(writes[0].owner == test::bridged_owner);
  CHECK(writes[0].key == "kitchen.f.switch");
  CHECK(writes[0].text == "on");
  CHECK(run_until(x, now + 1s).empty());
  static_cast<void>(x.on_tuple(bridged_news("kitchen.f.switch.outcome", "on failed"), now + 2s));
  CHECK(x.table().find("kitchen.f")->inputs.empty());
  const auto outputs =
      x.on_tuple(bridged_news("kitchen.f.switch.outcome", "on acknowledged"), now + 3s);
  REQUIRE(outputs.size() == 1);
  CHECK(std::get<publication>(outputs[0]).payload ==
        R"({"rssi":null,"switch":"on","switch_outcome":"acknowledged","speed":null})");
}

TEST_CASE("retained, unknown, refused and oversized commands are counted, not written",
          "[bridge][mqtt]") {
  auto x = with_fan();
  const auto now = start + 10s;
  const auto writes = [&](const delivery& message) {
    return writes_in(x.on_message(message, now)).size();
  };
  CHECK(writes({"rubicon/kitchen.f/set/switch", "on", true}) == 0);
  CHECK(x.counters().commands_retained == 1);
  CHECK(writes({"rubicon/kitchen.f/set/switch", "maybe"}) == 0);
  CHECK(writes({"rubicon/kitchen.f/set", "[1"}) == 0);
  CHECK(writes({"rubicon/kitchen.f/set", R"({"switch":{"a":1}})"}) == 0);
  CHECK(x.counters().commands_refused == 3);
  CHECK(writes({"rubicon/kitchen.f/set/door", "on"}) == 0);
  CHECK(writes({"rubicon/kitchen.+/set/switch", "on"}) == 0);
  CHECK(writes({"rubicon/kitchen.f/set/switch/#", "on"}) == 0);
  CHECK(x.counters().unknown_topics == 3);
  CHECK(writes({"rubicon/kitchen.f/set", std::string(10'000'000, '[')}) == 0);
  CHECK(writes({"rubicon/kitchen.f/set", std::string(1025, '[')}) == 0);
  CHECK(writes({std::string(257, 'x'), "on"}) == 0);
  CHECK(x.counters().oversized == 3);
  CHECK(x.counters().commands == 0);
}

TEST_CASE("a write that fails is counted apart from refused commands", "[bridge][mqtt]") {
  auto x = with_fan();
  const auto now = start + 10s;
  const auto writes = writes_in(x.on_message({"rubicon/kitchen.f/set/switch", "on"}, now));
  REQUIRE(writes.size() == 1);
  const auto outputs = x.on_written(writes[0].token, "no route", now);
  CHECK(x.counters().writes_failed == 1);
  CHECK(x.counters().commands_refused == 0);
  REQUIRE(outputs.size() == 1); // the state as it was
  CHECK(std::get<publication>(outputs[0]).topic == "rubicon/kitchen.f");
}

TEST_CASE("of a flood the first thousand messages of a second are read, and the newest commands",
          "[bridge][mqtt]") {
  auto x = with_fan();
  const auto now = start + 10s;
  for (std::size_t i = 0; i < flood_limit::received_max + 5; ++i)
    static_cast<void>(x.on_message({"rubicon/kitchen.f/get", "x"}, now));
  CHECK(x.counters().flooded == 5);
  for (const auto* word : {"on", "off", "on", "off"})
    CHECK(writes_in(x.on_message({"rubicon/kitchen.f/set/switch", word}, now)).empty());
  for (int i = 0; i < 100; ++i)
    CHECK(x.on_message({"rubicon/stranger" + std::to_string(i) + "/set", "{}"}, now).empty());
  CHECK(x.counters().flooded == 5 + 3 + 100);
  REQUIRE(x.deadline());
  CHECK(writes_in(x.on_time(now + 1s - 1ns)).empty());
  const auto writes = writes_in(x.on_time(now + 1s));
  REQUIRE(writes.size() == 1);
  CHECK(writes[0].text == "off");
  CHECK(writes_in(x.on_message({"rubicon/kitchen.f/set/switch", "on"}, now + 1s)).size() == 1);
}

TEST_CASE("a retained value is not followed by an older one of a flood", "[bridge][mqtt]") {
  mqtt_config config;
  config.topics.push_back({"window", "kitchen.window", payload_type::text, {}});
  mqtt_bridge x(config, {}, random_stream(1));
  static_cast<void>(x.on_connected(start));
  for (std::size_t i = 0; i < flood_limit::received_max; ++i)
    static_cast<void>(x.on_message({"window", "open"}, start));
  static_cast<void>(x.on_message({"window", "ajar"}, start));
  const auto newest = x.on_message({"window", "closed", true}, start);
  REQUIRE(newest.size() == 1);
  CHECK(to_string(byte_view(std::get<components::publish>(newest[0]).value)) == "closed");
  CHECK(x.counters().flooded == 1);
  for (const auto& each : x.on_time(start + 1s))
    CHECK(!std::holds_alternative<components::publish>(each));
}

TEST_CASE("a label is the name of the device", "[bridge][mqtt]") {
  mqtt_config config;
  config.labels["kitchen.f"] = "Küche / Lüfter";
  auto x = bridge_of(config);
  static_cast<void>(x.on_connected(start));
  static_cast<void>(x.on_tuple(bridged_news("Kitchen.F.class", "fan"), start));
  const auto sent = run_until(x, start + 4s);
  const auto at = place_of(sent, "homeassistant/device/rubicon-skitchen_f/config");
  REQUIRE(at);
  CHECK(sent[*at].what.payload.find("\"name\":\"Küche / Lüfter\"") != std::string::npos);
}

TEST_CASE("commands in flight are limited, and forgotten after a minute", "[bridge][mqtt]") {
  auto x = with_fan();
  const auto now = start + 10s;
  const delivery message{"rubicon/kitchen.f/set/switch", "on"};
  for (std::size_t i = 0; i < mqtt_bridge::open_commands_max; ++i)
    REQUIRE(writes_in(x.on_message(message, now)).size() == 1);
  CHECK(writes_in(x.on_message(message, now)).empty());
  static_cast<void>(run_until(x, now + mqtt_bridge::command_timeout));
  CHECK(writes_in(x.on_message(message, now + mqtt_bridge::command_timeout)).size() == 1);
}

TEST_CASE("announcements of an earlier life are removed unless their objects appear",
          "[bridge][mqtt]") {
  auto x = bridge_of();
  static_cast<void>(x.on_connected(start));
  for (const auto* name : {"kitchen.f", "kitchen.gone"}) {
    const auto availability = "rubicon/" + std::string(name) + "/availability";
    static_cast<void>(x.on_message({availability, R"({"state":"online"})", true}, start));
    const auto config = discovery_topic({"rubicon", "homeassistant"}, name);
    static_cast<void>(x.on_message({config, "{}", true}, start));
  }
  static_cast<void>(
      x.on_message({"homeassistant/device/other/config", R"({"o":"other"})", true}, start));
  static_cast<void>(x.on_tuple(bridged_news("kitchen.f.class", "fan"), start));
  const auto early = run_until(x, start + 8s);
  const auto marked = place_of(early, "rubicon/kitchen.gone/availability");
  REQUIRE(marked);
  CHECK(early[*marked].what.payload == R"({"state":"offline"})");
  const auto late = run_until(x, start + 11min);
  REQUIRE(late.size() == 3);
  for (const auto& each : late)
    CHECK(each.what.payload.empty());
  CHECK(place_of(late, "homeassistant/device/rubicon-skitchen_gone/config"));
  CHECK(place_of(late, "rubicon/kitchen.gone"));
  CHECK(place_of(late, "rubicon/kitchen.gone/availability"));
}

TEST_CASE("after a birth message all is announced, at most once in ten seconds", "[bridge][mqtt]") {
  auto x = with_fan();
  for (int i = 0; i < 5; ++i)
    static_cast<void>(x.on_message({"homeassistant/status", "online"}, start + 20s));
  CHECK(run_until(x, start + 22s).size() == 5);
  static_cast<void>(x.on_message({"homeassistant/status", "online"}, start + 22s));
  CHECK(run_until(x, start + 29s).empty());
  CHECK(run_until(x, start + 33s).size() == 5);
}

TEST_CASE("topics become tuples of their type", "[bridge][mqtt]") {
  mqtt_config config;
  config.topics = {{"z/lamp", "lamp.power", payload_type::number, "power"},
                   {"z/lamp", "lamp.state", payload_type::flag, "state"}};
  auto x = bridge_of(config);
  const auto set = [&x](std::string_view payload) {
    std::vector<std::string> out;
    for (const auto& each : x.on_message({"z/lamp", payload}, start)) {
      const auto& tuple = std::get<components::publish>(each);
      out.push_back(tuple.key + '=' + to_string(byte_view(tuple.value)));
    }
    return out;
  };
  using texts = std::vector<std::string>;
  CHECK(set(R"({"power":4.5,"state":"ON"})") == texts{"lamp.power=4.5", "lamp.state=on"});
  CHECK(set(R"({"power":"high","state":true})") == texts{"lamp.state=on"});
  CHECK(x.counters().bad_payloads == 1);
  CHECK(set("\xff{").empty());
  CHECK(x.counters().bad_payloads == 3);
}

TEST_CASE("1000 objects of 4 fields are announced in 10 s at 200 messages a second at most",
          "[bridge][mqtt]") {
  std::vector<class_model> classes{{"many", "hall.*", {}, {}}};
  classes[0].fields = {{"a", "C", {}}, {"b", "%", {}}, {"c", "lx", {}}, {"d", "ppm", {}}};
  mqtt_bridge x({}, classes, random_stream(2));
  for (int i = 0; i < 1000; ++i) {
    const auto name = "hall.m" + std::to_string(i);
    static_cast<void>(x.on_tuple(bridged_news(name + ".class", "many"), start));
    static_cast<void>(x.on_tuple(bridged_news(name + ".status", "active"), start));
  }
  static_cast<void>(x.on_connected(start));
  const auto sent = run_until(x, start + 30s);
  REQUIRE(sent.size() == 3002);
  std::size_t announced = 0;
  for (std::size_t i = 0; i < sent.size(); ++i) {
    announced += sent[i].what.topic.ends_with("/config") && sent[i].at < start + 10s ? 1 : 0;
    if (i >= 200)
      REQUIRE(sent[i].at - sent[i - 200].at > 1s - 1ms);
  }
  CHECK(announced == 1000);
}

TEST_CASE("filters of subscriptions have wildcards for one level and for the rest",
          "[bridge][mqtt]") {
  CHECK(filter_includes("a/+/c", "a/b/c"));
  CHECK(!filter_includes("a/+", "a/b/c"));
  CHECK(filter_includes("a/#", "a/b/c"));
  CHECK(filter_includes("a/#", "a"));
  CHECK(!filter_includes("#", "$SYS/x"));
  CHECK(!filter_includes("a/b", "a"));
}

TEST_CASE("a birth message of Home Assistant may become a tuple as well", "[bridge][mqtt]") {
  mqtt_config config;
  config.topics = {{"homeassistant/status", "home.state", payload_type::text, ""}};
  auto x = with_fan(config);
  const auto outputs = x.on_message({"homeassistant/status", "online"}, start + 20s);
  REQUIRE(outputs.size() == 1);
  CHECK(std::get<components::publish>(outputs[0]).key == "home.state");
  CHECK(x.counters().births == 1);
  CHECK(x.counters().unknown_topics == 0);
}

TEST_CASE("a command without outcome is counted after a minute", "[bridge][mqtt]") {
  auto x = with_fan();
  const auto now = start + 10s;
  const delivery message{"rubicon/kitchen.f/set/switch", "on"};
  REQUIRE(writes_in(x.on_message(message, now)).size() == 1);
  REQUIRE(writes_in(x.on_message(message, now + 30s)).size() == 1);
  static_cast<void>(run_until(x, now + mqtt_bridge::command_timeout));
  CHECK(x.counters().commands_unanswered == 1);
  static_cast<void>(x.on_tuple(bridged_news("kitchen.f.switch.outcome", "on sent"), now + 61s));
  static_cast<void>(run_until(x, now + 2min));
  CHECK(x.counters().commands_unanswered == 1);
}

TEST_CASE("a flood of retained messages costs no more than its limits", "[bridge][mqtt]") {
  auto x = bridge_of();
  static_cast<void>(x.on_connected(start));
  std::size_t sent = 0;
  for (std::size_t i = 0; i < flood_limit::retained_max + 5; ++i) {
    const auto topic = "rubicon/kitchen.g" + std::to_string(i) + "/availability";
    sent += x.on_message({topic, R"({"state":"online"})", true}, start).size();
  }
  CHECK(x.counters().flooded == 5);
  CHECK(sent <= 190);
  CHECK(x.queue().size() <= expiry_list::names_max);
  x.on_disconnected();
  static_cast<void>(x.on_connected(start + 1s));
  static_cast<void>(x.on_message({"rubicon/kitchen.f/set", "{}", true}, start + 1s));
  CHECK(x.counters().flooded == 5);
}

TEST_CASE("objects that disappear in great numbers are removed at once beyond a limit",
          "[bridge][mqtt]") {
  auto x = bridge_of();
  static_cast<void>(x.on_connected(start));
  static_cast<void>(run_until(x, start + 8s));
  for (std::size_t i = 0; i <= expiry_list::names_max; ++i) {
    const auto key = "kitchen.f" + std::to_string(i) + ".class";
    static_cast<void>(x.on_tuple(bridged_news(key, "fan"), start + 10s));
    static_cast<void>(x.on_tuple(test::bridged_deletion(key), start + 10s));
  }
  CHECK(x.counters().removed == 1);
}

TEST_CASE("a list of names returns each once, and is limited", "[bridge][mqtt]") {
  expiry_list x;
  CHECK(!x.deadline());
  CHECK(x.add("a", start + 2s));
  CHECK(x.add("a", start + 9s)); // keeps its time
  CHECK(x.add("b", start + 1s));
  CHECK(x.deadline() == start + 1s);
  x.erase("b");
  CHECK(x.take(start + 1s).empty());
  CHECK(x.deadline() == start + 2s);
  CHECK(x.take(start + 2s) == std::vector<std::string>{"a"});
  CHECK(!x.deadline());
  for (std::size_t i = 0; i < expiry_list::names_max; ++i)
    REQUIRE(x.add(std::to_string(i), start + 3s));
  CHECK(!x.add("one more", start + 3s));
  CHECK(x.take(start + 3s).size() == expiry_list::names_max);
}

TEST_CASE("a payload of many brackets is no value, and harms nobody", "[bridge][mqtt]") {
  mqtt_config config;
  config.topics = {{"z/lamp", "lamp.power", payload_type::number, "power"}};
  auto x = bridge_of(config);
  const auto half = mqtt_bridge::payload_max / 2;
  const auto nested = std::string(half, '[') + std::string(half, ']');
  CHECK(x.on_message({"z/lamp", nested}, start).empty());
  CHECK(x.on_message({"z/lamp", std::string(half, '[')}, start).empty());
  CHECK(x.counters().bad_payloads == 2);
}
