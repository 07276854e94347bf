#include <string>
#include <variant>
#include <vector>

#include "bridge/ros2/simulated_ros2.hpp"
#include "support/catch.hpp"
#include "support/start.hpp"

using namespace rubicon;
using namespace rubicon::bridge;
using test::start;

namespace {

constexpr peer_id service_peer{30};
constexpr peer_id fan_peer{40};

/// Watches: 1 and 2 of the fan's tuple and its outcome, 3 and 4 of the goal, 5 of the request.
ros2_config ros2_with_services() {
  ros2_config x;
  offered_service fan;
  fan.service = "fan/set";
  fan.key = "kitchen.fan.switch";
  fan.timeout = 5s;
  x.offers.push_back(fan);
  offered_service goal;
  goal.service = "robot/go";
  goal.type = "my_msgs/srv/Go";
  goal.key = "robot.goal";
  goal.outcome = "robot.outcome";
  goal.member = "place.name";
  goal.content = R"({"done":"$success"})";
  x.offers.push_back(goal);
  requested_service lamp;
  lamp.key = "lamp.wanted";
  lamp.service = "/lamp/set";
  lamp.type = "std_srvs/srv/SetBool";
  lamp.timeout = 5s;
  x.requests.push_back(lamp);
  return x;
}

components::news service_news(std::uint64_t watch, std::string_view key, std::string_view text) {
  return {watch, fan_peer, key, text, false};
}

simulated_ros2 served_fan() {
  simulated_ros2 x(ros2_bridge(ros2_with_services(), random_stream(1)), service_peer);
  static_cast<void>(x.start(start));
  static_cast<void>(x.on_tuple(service_news(1, "kitchen.fan.switch", "off"), start));
  return x;
}

const components::write& only_write(const components::outputs& from) {
  REQUIRE(from.size() == 1);
  return std::get<components::write>(from[0]);
}

} // namespace

TEST_CASE("a call of a service is written once and answered with its outcome", "[bridge][ros2]") {
  auto x = served_fan();
  const auto outputs = x.call("/fan/set", "c1", R"({"data":true})", start);
  const auto& write = only_write(outputs);
  CHECK(write.owner == fan_peer);
  CHECK(write.key == "kitchen.fan.switch");
  CHECK(write.text == "on");
  CHECK(x.on_written(write.token, "", start).empty());
  CHECK(x.server().answers().empty());
  static_cast<void>(x.on_tuple(service_news(2, "kitchen.fan.switch.outcome", "off sent"), start));
  CHECK(x.server().answers().empty());
  static_cast<void>(
      x.on_tuple(service_news(2, "kitchen.fan.switch.outcome", "on acknowledged"), start));
  CHECK(x.server().answers().at("c1") == R"({"message":"acknowledged","success":true})");
  CHECK(x.core().services().calls_succeeded == 1);
}

TEST_CASE("a call whose write fails, or that has no outcome, is answered so", "[bridge][ros2]") {
  auto x = served_fan();
  const auto outputs = x.call("/fan/set", "c1", R"({"data":false})", start);
  static_cast<void>(x.on_written(only_write(outputs).token, "timeout of the peer", start));
  CHECK(x.server().answers().at("c1") == R"({"message":"timeout of the peer","success":false})");
  static_cast<void>(x.call("/fan/set", "c2", R"({"data":false})", start));
  static_cast<void>(x.on_time(start + 5s));
  CHECK(x.server().answers().at("c2") == R"({"message":"timeout","success":false})");
  static_cast<void>(x.call("/fan/set", "c3", R"({"data":"yes"})", start));
  CHECK(x.server().answers().at("c3") == R"({"message":"bad request","success":false})");
  static_cast<void>(x.call("/robot/go", "c4", R"({"place":{"name":"kitchen"}})", start));
  CHECK(x.server().answers().at("c4") == R"({"done":false})"); // no such tuple
  CHECK(x.core().services().calls == 4);
  CHECK(x.core().services().calls_failed == 4);
}

TEST_CASE("a goal is a service with a request and an answer of its own", "[bridge][ros2]") {
  auto x = served_fan();
  static_cast<void>(x.on_tuple(service_news(3, "robot.goal", "none"), start));
  const auto outputs = x.call("/robot/go", "c1", R"({"place":{"name":"at kitchen"}})", start);
  CHECK(only_write(outputs).text == "at kitchen");
  static_cast<void>(x.on_tuple(service_news(4, "robot.outcome", "at kitchen succeeded"), start));
  CHECK(x.server().answers().at("c1") == R"({"done":true})");
}

TEST_CASE("calls that are open are limited, and lost with their connection", "[bridge][ros2]") {
  auto x = served_fan();
  for (std::size_t i = 0; i <= ros2_services::open_max; ++i)
    static_cast<void>(x.call("/fan/set", "c" + std::to_string(i), R"({"data":true})", start));
  CHECK(x.core().services().calls_failed == 1);
  static_cast<void>(x.stop_server(start));
  CHECK(x.core().services().calls_lost == ros2_services::open_max);
}

TEST_CASE("a value of a tuple is a request with one outcome", "[bridge][ros2]") {
  ros2_bridge x(ros2_with_services(), random_stream(1));
  static_cast<void>(x.start(start));
  const auto outcome_of = [](const ros2_outputs& outputs) {
    REQUIRE(outputs.size() == 1);
    const auto& found = std::get<components::publish>(outputs[0]);
    CHECK(found.key == "lamp.wanted.outcome");
    return to_string(byte_view(found.value));
  };
  const auto wanted = service_news(5, "lamp.wanted", "on");
  CHECK(outcome_of(x.on_tuple(wanted, start)) == "on unreachable");
  static_cast<void>(x.on_connected(start));
  const auto outputs = x.on_tuple(wanted, start);
  REQUIRE(outputs.size() == 1);
  const auto& text = std::get<ros2_text>(outputs[0]).text;
  CHECK(text.find(R"("args":{"data":true})") != std::string::npos);
  CHECK(text.find(R"("id":"request:1")") != std::string::npos);
  CHECK(outcome_of(x.on_text(
            R"({"op":"service_response","id":"request:1","result":true,"values":{"success":true}})",
            start)) == "on succeeded");
  CHECK(x.on_text(R"({"op":"service_response","id":"request:1","result":true})", start).empty());
  static_cast<void>(x.on_tuple(wanted, start));
  CHECK(
      outcome_of(x.on_text(
          R"({"op":"service_response","id":"request:2","result":true,"values":{"success":false}})",
          start)) == "on failed");
  static_cast<void>(x.on_tuple(wanted, start));
  CHECK(outcome_of(x.on_time(start + 5s)) == "on timeout");
  static_cast<void>(x.on_tuple(wanted, start + 5s));
  CHECK(outcome_of(x.on_disconnected(start + 6s)) == "on unreachable");
  CHECK(outcome_of(x.on_tuple(service_news(5, "lamp.wanted", "dim"), start + 6s)) == "dim failed");
  CHECK(x.services().requests == 6);
  CHECK(x.services().requests_succeeded == 1);
  CHECK(x.services().requests_failed == 5);
}
