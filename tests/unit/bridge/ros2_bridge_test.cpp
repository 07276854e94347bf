#include <algorithm>
#include <string>
#include <variant>
#include <vector>

#include "bridge/ros2/message_heading.hpp"
#include "bridge/ros2/simulated_ros2.hpp"
#include "support/catch.hpp"
#include "support/start.hpp"

using namespace rubicon;
using namespace rubicon::bridge;
using test::start;

namespace {

constexpr peer_id own_peer{30};
constexpr peer_id other_peer{40};

ros2_config ros2_of_a_kitchen() {
  ros2_config x;
  x.name_space = "home";
  topic_publication temperature;
  temperature.key = "kitchen.*.temperature";
  temperature.topic = "kitchen/{1}/temperature";
  temperature.type = "sensor_msgs/msg/Temperature";
  temperature.frame = "kitchen";
  x.publications.push_back(temperature);
  topic_publication fan;
  fan.key = "kitchen.fan.switch";
  fan.topic = "/fan";
  fan.type = "std_msgs/msg/Bool";
  fan.latch = false;
  fan.queue = 3;
  x.publications.push_back(fan);
  topic_subscription target;
  target.topic = "target";
  target.key = "robot.target";
  target.type = "geometry_msgs/msg/PoseStamped";
  x.subscriptions.push_back(target);
  return x;
}

simulated_ros2 bridged(ros2_config config) {
  simulated_ros2 x(ros2_bridge(std::move(config), random_stream(1)), own_peer);
  static_cast<void>(x.start(start));
  return x;
}

components::news set_at(std::uint64_t watch, std::string_view key, std::string_view text,
                        peer_id owner = other_peer) {
  return {watch, owner, key, text, false};
}

template <class Outputs>
std::vector<std::string> set_tuples_of(const Outputs& from) {
  std::vector<std::string> out;
  for (const auto& each : from)
    if (const auto* found = std::get_if<components::publish>(&each))
      out.push_back(found->key + '=' + to_string(byte_view(found->value)));
  return out;
}

std::vector<std::string> set_tuples(const components::outputs& from) {
  return set_tuples_of(from);
}

/// Until then, as its actor would.
components::outputs run_until(simulated_ros2& x, instant end) {
  components::outputs out;
  for (auto due = x.deadline(); due && *due <= end; due = x.deadline())
    for (auto& each : x.on_time(*due))
      out.push_back(std::move(each));
  return out;
}

} // namespace

TEST_CASE("tuples are messages of the topics that are listed for them", "[bridge][ros2]") {
  auto x = bridged(ros2_of_a_kitchen());
  CHECK(x.server().topics().size() == 1);
  CHECK(x.server().subscriptions().contains("/home/target"));
  static_cast<void>(
      x.on_tuple(set_at(1, "kitchen.south-wall.temperature", "21.5"), start + 2500ms));
  static_cast<void>(x.on_tuple(set_at(2, "kitchen.fan.switch", "on"), start + 3s));
  REQUIRE(x.server().topics().contains("/home/kitchen/south_wall/temperature"));
  const auto& topic = x.server().topics().at("/home/kitchen/south_wall/temperature");
  CHECK(topic.type == "sensor_msgs/msg/Temperature");
  CHECK(topic.latched);
  CHECK(topic.newest == R"({"header":{"frame_id":"kitchen","stamp":{"nanosec":500000000,"sec":2}},)"
                        R"("temperature":21.5})");
  CHECK(x.server().topics().at("/fan").newest == R"({"data":true})");
  CHECK(x.server().refused() == 0);
}

TEST_CASE("a text that does not fit the type of its topic is counted", "[bridge][ros2]") {
  auto x = bridged(ros2_of_a_kitchen());
  static_cast<void>(x.on_tuple(set_at(1, "kitchen.a.temperature", "unknown"), start));
  static_cast<void>(x.on_tuple(set_at(1, "kitchen.a.temperature", std::string(300, '1')), start));
  static_cast<void>(x.on_tuple(set_at(2, "kitchen.fan.switch", "half"), start));
  CHECK(x.core().counters().bad_values == 3);
  CHECK(x.core().counters().published == 0);
}

TEST_CASE("messages of a topic become the tuple of the bridge's peer", "[bridge][ros2]") {
  auto x = bridged(ros2_of_a_kitchen());
  CHECK(set_tuples(x.publish("/home/target", R"({"pose":{"position":{"x":1.5,"y":-2,"z":0}}})",
                             start)) == std::vector<std::string>{"robot.target=1.5 -2 0"});
  CHECK(
      set_tuples(x.publish("/home/target", R"({"pose":{"position":{"x":"far"}}})", start)).empty());
  CHECK(x.core().counters().tuples_set == 1);
  CHECK(x.core().counters().bad_messages == 1);
}

TEST_CASE("what the file does not list has no effect", "[bridge][ros2]") {
  ros2_bridge x(ros2_of_a_kitchen(), random_stream(1));
  static_cast<void>(x.start(start));
  static_cast<void>(x.on_connected(start));
  for (const auto* text : {R"({"op":"publish","topic":"/other","msg":{"data":1}})",
                           R"({"op":"publish","topic":"target","msg":{"data":1}})",
                           R"({"op":"call_service","service":"/shutdown","args":{}})"})
    CHECK(x.on_text(text, start).empty());
  CHECK(x.counters().unlisted == 3);
}

TEST_CASE("hostile messages are dropped and counted", "[bridge][ros2]") {
  ros2_bridge x(ros2_of_a_kitchen(), random_stream(1));
  static_cast<void>(x.start(start));
  static_cast<void>(x.on_connected(start));
  const std::string deep =
      R"({"op":"publish","topic":"/home/target","msg":)" + std::string(30'000, '[') + '}';
  const std::string nested = std::string(40, '[') + std::string(40, ']');
  for (const auto& text :
       {std::string("no JSON"), std::string("[1]"), std::string(R"({"op":7})"), deep,
        R"({"op":"publish","topic":"/home/target","msg":)" + nested + '}', std::string(R"({"op":)"),
        std::string("\xff\xfe"), std::string(R"({"op":"fragment","num":0})")})
    CHECK(x.on_text(text, start).empty());
  CHECK(x.counters().malformed == 8);
  CHECK(x.on_text(std::string(ros2_bridge::message_max + 1, ' '), start).empty());
  CHECK(x.counters().oversized == 1);
  static_cast<void>(x.on_text(R"({"op":"status","level":"error","msg":"no"})", start));
  CHECK(x.counters().server_errors == 1);
}

TEST_CASE("of a flood the first messages of each second are read, and the newest of each topic",
          "[bridge][ros2]") {
  auto config = ros2_of_a_kitchen();
  config.subscriptions.push_back(config.subscriptions[0]);
  config.subscriptions[1].topic = "other";
  config.subscriptions[1].key = "robot.other";
  ros2_bridge x(config, random_stream(1));
  static_cast<void>(x.start(start));
  static_cast<void>(x.on_connected(start));
  const auto at = [](std::string_view topic, std::size_t i) {
    return R"({"op":"publish","topic":"/home/)" + std::string(topic) +
           R"(","msg":{"pose":{"position":{"x":)" + std::to_string(i) + R"(,"y":2,"z":3}}}})";
  };
  for (std::size_t i = 0; i < ros2_bridge::received_max; ++i)
    CHECK(set_tuples_of(x.on_text(at("target", i), start)).size() == 1);
  for (std::size_t i = 0; i < 7; ++i) {
    CHECK(x.on_text(at("target", 100 + i), start).empty());
    CHECK(x.on_text(at("other", 200 + i), start + 10ms).empty());
  }
  CHECK(x.on_text(R"({"op":"publish","topic":"/unlisted","msg":{}})", start).empty());
  CHECK(x.on_text(R"({"op":"call_service","service":"/fan"})", start).empty());
  CHECK(x.on_text("no JSON", start).empty());
  CHECK(x.counters().flooded == 6 + 6 + 3);
  REQUIRE(x.deadline() == start + 1s);
  CHECK(x.on_time(start + 1s - 1ns).empty());
  CHECK(set_tuples_of(x.on_time(start + 1s)) ==
        std::vector<std::string>{"robot.other=206 2 3", "robot.target=106 2 3"});
  CHECK(!x.deadline());
  CHECK(set_tuples_of(x.on_text(at("target", 300), start + 1s)) ==
        std::vector<std::string>{"robot.target=300 2 3"});
}

TEST_CASE("a value that waits is set before those that come later", "[bridge][ros2]") {
  ros2_bridge x(ros2_of_a_kitchen(), random_stream(1));
  static_cast<void>(x.start(start));
  static_cast<void>(x.on_connected(start));
  const auto at = [](std::string_view value) {
    return R"({"op":"publish","topic":"/home/target","msg":{"pose":{"position":{"x":)" +
           std::string(value) + R"(,"y":2,"z":3}}}})";
  };
  for (std::size_t i = 0; i <= ros2_bridge::received_max; ++i)
    static_cast<void>(x.on_text(at("1"), start));
  CHECK(set_tuples_of(x.on_text(at("2"), start + 1s)) ==
        std::vector<std::string>{"robot.target=1 2 3", "robot.target=2 2 3"});
}

TEST_CASE("the topic of a message is known without reading it", "[bridge][ros2]") {
  CHECK(topic_of_publication(R"({"op":"publish","topic":"/a","msg":no JSON)") == "/a");
  CHECK(topic_of_publication(R"({"topic":"/a","msg":{"op":"x","topic":"/b"},"op":"publish"})") ==
        "/a");
  CHECK(topic_of_publication(R"({"topic":"/a","msg":)" + std::string(60'000, '[')).empty());
  CHECK(topic_of_publication(R"({"op":"subscribe","topic":"/a"})").empty());
  CHECK(topic_of_publication(R"({"op":"publish","topic":7})").empty());
  CHECK(topic_of_publication(R"([{"op":"publish","topic":"/a"}])").empty());
  CHECK(topic_of_publication("").empty());
}

TEST_CASE("after each connection all is advertised, and latched messages are sent again",
          "[bridge][ros2]") {
  auto x = bridged(ros2_of_a_kitchen());
  static_cast<void>(x.on_tuple(set_at(1, "kitchen.a.temperature", "21"), start));
  static_cast<void>(x.on_tuple(set_at(2, "kitchen.fan.switch", "on"), start));
  for (int life = 1; life <= 50; ++life) {
    INFO("life " << life);
    const auto now = start + life * 1min;
    static_cast<void>(x.stop_server(now));
    static_cast<void>(x.on_tuple(set_at(1, "kitchen.a.temperature", std::to_string(life)), now));
    static_cast<void>(run_until(x, now + 20s));
    CHECK(!x.core().is_connected());
    x.start_server();
    static_cast<void>(run_until(x, now + 40s));
    REQUIRE(x.core().is_connected());
    const auto& topic = x.server().topics().at("/home/kitchen/a/temperature");
    CHECK(topic.newest.find("\"temperature\":" + std::to_string(life) + ".0") != std::string::npos);
    CHECK(x.server().topics().at("/fan").newest.empty());
    CHECK(x.server().subscriptions().size() == 1);
  }
  CHECK(x.core().counters().connections == 51);
  CHECK(x.core().counters().unconnected == 50);
  CHECK(x.core().outbox().size() == 0);
}

TEST_CASE("pauses between attempts double up to eight seconds", "[bridge][ros2]") {
  ros2_bridge x(ros2_of_a_kitchen(), random_stream(1));
  static_cast<void>(x.start(start));
  auto now = start;
  for (const duration expected : {250ms, 500ms, 1000ms, 2000ms, 4000ms, 8000ms, 8000ms}) {
    static_cast<void>(x.on_disconnected(now));
    const auto due = x.deadline();
    REQUIRE(due);
    CHECK(*due - now >= expected * 3 / 4);
    CHECK(*due - now <= expected * 5 / 4);
    now = *due;
    const auto outputs = x.on_time(now);
    REQUIRE(outputs.size() == 1);
    CHECK(std::holds_alternative<open_connection>(outputs[0]));
    CHECK(!x.deadline());
  }
}

TEST_CASE("while messages are not sent, each topic keeps its newest ones", "[bridge][ros2]") {
  auto config = ros2_of_a_kitchen();
  ros2_bridge x(config, random_stream(1));
  static_cast<void>(x.start(start));
  std::size_t handed_over = x.on_connected(start).size();
  for (int i = 0; i < 10'000; ++i)
    handed_over +=
        x.on_tuple(set_at(2, "kitchen.fan.switch", i % 2 == 0 ? "on" : "off"), start).size();
  CHECK(handed_over == ros2_bridge::in_flight_max);
  CHECK(x.outbox().size() == 3);
  CHECK(x.outbox().longest() == 3);
  CHECK(x.outbox().dropped() == 10'000 + 2 - ros2_bridge::in_flight_max - 3);
  const auto rest = x.on_sent(handed_over, start);
  REQUIRE(rest.size() == 3);
  CHECK(std::get<ros2_text>(rest[2]).text.find("false") != std::string::npos);
}

TEST_CASE("a topic is not published more often than its file allows", "[bridge][ros2]") {
  auto config = ros2_of_a_kitchen();
  config.publications[0].every = 100ms;
  auto x = bridged(config);
  for (int i = 0; i < 1000; ++i) {
    static_cast<void>(run_until(x, start + i * 1ms));
    static_cast<void>(
        x.on_tuple(set_at(1, "kitchen.a.temperature", std::to_string(i)), start + i * 1ms));
  }
  static_cast<void>(run_until(x, start + 1s));
  const auto& topic = x.server().topics().at("/home/kitchen/a/temperature");
  CHECK(topic.messages == 11);
  CHECK(topic.newest.find("\"temperature\":999.0") != std::string::npos);
}

TEST_CASE("no more topics are published than there may be", "[bridge][ros2]") {
  auto x = bridged(ros2_of_a_kitchen());
  for (std::size_t i = 0; i < topic_rules::topics_max + 5; ++i)
    static_cast<void>(
        x.on_tuple(set_at(1, "kitchen.m" + std::to_string(i) + ".temperature", "1"), start));
  CHECK(x.server().topics().size() == topic_rules::topics_max);
  CHECK(x.core().counters().topics_full == 6);
}

TEST_CASE("the clock of nodes is the ecology's time", "[bridge][ros2]") {
  auto config = ros2_of_a_kitchen();
  config.clock_every = 100ms;
  auto x = bridged(config);
  static_cast<void>(run_until(x, start + 2350ms));
  const auto& clock = x.server().topics().at("/clock");
  CHECK(clock.type == "rosgraph_msgs/msg/Clock");
  CHECK(clock.messages == 24);
  CHECK(clock.newest == R"({"clock":{"nanosec":300000000,"sec":2}})");
}

TEST_CASE("without a clock, headers have the time of the system", "[bridge][ros2]") {
  ros2_bridge x(ros2_of_a_kitchen(), random_stream(1), 1'700'000'000s);
  static_cast<void>(x.start(start));
  static_cast<void>(x.on_connected(start));
  const auto outputs = x.on_tuple(set_at(1, "kitchen.a.temperature", "1"), start + 5s);
  REQUIRE(outputs.size() == 2);
  CHECK(std::get<ros2_text>(outputs[1]).text.find("\"sec\":1700000005") != std::string::npos);
}

TEST_CASE("ten thousand seconds of a bridge leave nothing behind", "[bridge][ros2]") {
  auto config = ros2_of_a_kitchen();
  config.subscriptions[0].topic = "/fan"; // what it publishes comes back
  config.subscriptions[0].type = "std_msgs/msg/Bool";
  config.subscriptions[0].key = "echo";
  config.clock_every = 1s;
  auto x = bridged(config);
  std::size_t echoes = 0;
  for (int i = 0; i < 10'000; ++i) {
    const auto now = start + i * 1s;
    static_cast<void>(run_until(x, now));
    echoes +=
        set_tuples(x.on_tuple(set_at(2, "kitchen.fan.switch", i % 2 == 0 ? "on" : "off"), now))
            .size();
  }
  CHECK(echoes == 10'000);
  CHECK(x.core().outbox().size() == 0);
  CHECK(x.core().outbox().longest() <= 2);
  CHECK(x.core().outbox().dropped() == 0);
}
