#include <algorithm>
#include <string>
#include <variant>

#include "bridge/ros2/ros2_settings.hpp"
#include "bridge/ros2/rosbridge_place.hpp"
#include "config/checks/tuple_keys.hpp"
#include "config/checks/warnings.hpp"
#include "config/run/summary.hpp"
#include "support/catch.hpp"
#include "unit/config/sample.hpp"

using namespace rubicon;
using namespace rubicon::config;
using rubicon::test::check_mistakes;
using rubicon::test::good;

TEST_CASE("[[ros2]] is a bridge beside the kernel of its peer", "[config][ros2]") {
  const auto x = good(std::string(test::head) + R"([[ros2]]
peer = "pc"
server = "robot.local:9090"
namespace = "home"
clock = "100ms"
publish = [{ key = "kitchen.*.temperature", topic = "{1}/temperature", type = "sensor_msgs/Temperature", every = "1s" },
           { key = "a.b", topic = "ab", type = "my_msgs/AB", message = '{ "ab": "$number" }', latch = false }]
subscribe = [{ topic = "/scan", type = "sensor_msgs/msg/LaserScan", key = "scan.front", member = "ranges.0", value = "number" }]
service = [{ service = "fan", key = "kitchen.fan.switch" },
           { service = "stop", type = "std_srvs/Trigger", key = "robot.goal", outcome = "robot.outcome", value = "none" }]
call = [{ key = "lamp", service = "/lamp", type = "std_srvs/SetBool", timeout = "3s" }]
)");
  const auto& app = std::get<ros2_app>(x.peers.at(0).apps.at(0));
  CHECK(app.settings->server == "robot.local:9090");
  const auto& all = app.settings->bridge;
  CHECK(all.name_space == "home");
  CHECK(all.clock_every == 100ms);
  REQUIRE(all.publications.size() == 2);
  CHECK(all.publications[0].type == "sensor_msgs/msg/Temperature");
  CHECK(all.publications[0].every == 1s);
  CHECK(all.publications[0].latch);
  CHECK(!all.publications[1].latch);
  REQUIRE(all.subscriptions.size() == 1);
  CHECK(all.subscriptions[0].value == bridge::payload_type::number);
  REQUIRE(all.offers.size() == 2);
  CHECK(all.offers[0].type == "std_srvs/srv/SetBool");
  CHECK(all.offers[1].value == "none");
  REQUIRE(all.requests.size() == 1);
  CHECK(all.requests[0].timeout == 3s);
  CHECK(summary(x).find("ROS 2 bridge (simulated rosbridge)") != std::string::npos);
  const auto known = [&x](std::string_view key) {
    return std::ranges::any_of(tuple_keys(x),
                               [key](const auto& each) { return each.pattern == key; });
  };
  CHECK(known("scan.front"));
  CHECK(known("lamp.outcome"));
}

TEST_CASE("a rosbridge may be behind TLS", "[config][ros2]") {
  const auto settings_of = [](const std::string& keys) {
    const auto x = good(std::string(test::head) + "[[ros2]]\npeer = \"pc\"\n" + keys);
    return std::get<ros2_app>(x.peers.at(0).apps.at(0)).settings;
  };
  const auto secure = settings_of("server = \"wss://robot:443\"\nca_file = \"ca.crt\"\n");
  CHECK(secure->ca_file == "ca.crt");
  CHECK(secure->verify);
  const auto place = bridge::parse_rosbridge_place(secure->server);
  REQUIRE(place);
  CHECK(place->tls);
  CHECK(place->where.host == "robot");
  CHECK(place->where.port == 443);
  CHECK(!bridge::parse_rosbridge_place("ws://robot:9090")->tls);
  CHECK(!bridge::parse_rosbridge_place("robot:9090")->tls);
  for (const auto* none :
       {"wss://robot", "wss://:9090", "wss://robot:9090/", "wss://", "https://a:1"})
    CHECK(!bridge::parse_rosbridge_place(none));
}

TEST_CASE("mistakes in [[ros2]] are reported where they are", "[config][ros2]") {
  check_mistakes(std::string(test::head), R"(
[[ros2]]
peer = "robot"
#      ^ no peer is named `robot`: there is pc

[[ros2]]
peer = "pc"
server = "localhost"
#        ^ `server` must be HOST:PORT or wss://HOST:PORT, as in "127.0.0.1:9090"

[[ros2]]
peer = "pc"
server = "http://robot:9090"
#        ^ `server` must be HOST:PORT or wss://HOST:PORT, as in "127.0.0.1:9090"

[[ros2]]
peer = "pc"
server = "robot:9090"
ca_file = "ca.crt"
#         ^ `ca_file` needs TLS: `server = "wss://robot:9090"`

[[ros2]]
peer = "pc"
server = "wss://robot:9090"
verify = false
ca_file = "ca.crt"
#         ^ `ca_file` has no use with `verify = false`

[[ros2]]
peer = "pc"
[[ros2.publish]]
key = "a.b"
topic = "a-b"
#       ^ `a-b` is no name in ROS: letters, digits and `_` between slashes, as in `kitchen/fan`
type = "std_msgs/Float64"

[[ros2]]
peer = "pc"
[[ros2.publish]]
key = "a.b"
topic = "ab"
type = "std_msgs/Floot64"
#      ^ `std_msgs/msg/Floot64` needs `message`: did you mean `std_msgs/msg/Float64`?

[[ros2]]
peer = "pc"
[[ros2.publish]]
key = "a.b"
topic = "ab"
type = "Float64"
#      ^ `Float64` is no type of ROS: give PACKAGE/NAME

[[ros2]]
peer = "pc"
[[ros2.publish]]
key = "a.b"
topic = "ab"
type = "my_msgs/AB"
message = '{ "a": "$nummer" }'
#         ^ no blank is named `$nummer`: did you mean `number`?

[[ros2]]
peer = "pc"
[[ros2.publish]]
key = "a.*"
topic = "/ab"
type = "std_msgs/Bool"
[[ros2.subscribe]]
topic = "ab"
type = "std_msgs/Bool"
key = "a.b"
#     ^ `a.b` is published on the topic that sets it

[[ros2]]
peer = "pc"
clock = "1s"
[[ros2.publish]]
key = "a.b"
topic = "/clock"
#       ^ `/clock` is published by `clock`
type = "std_msgs/Bool"

[[ros2]]
peer = "pc"
[[ros2.call]]
key = "a.b"
service = "ab"
type = "my_srvs/AB"
#      ^ `my_srvs/srv/AB` needs `request`
)");
}

TEST_CASE("a tuple that nobody publishes is pointed out where a bridge to ROS 2 has it",
          "[config][ros2]") {
  const auto x = load_text(std::string(test::head) + R"([[ros2]]
peer = "pc"
publish = [{ key = "scan.back", topic = "back", type = "std_msgs/Bool" }]
subscribe = [{ topic = "/front", type = "std_msgs/Bool", key = "scan.front" }]
)",
                           "t.toml", {}, {});
  REQUIRE(x.problems.empty());
  const auto warnings = warnings_of(x, "t.toml");
  REQUIRE(warnings.size() == 1);
  const auto text = to_string(warnings[0]);
  CAPTURE(text);
  CHECK(text.find("the ROS 2 bridge of pc publishes `scan.back`, a tuple that no component "
                  "publishes") != std::string::npos);
}
