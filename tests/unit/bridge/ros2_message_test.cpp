#include <string>

#include <nlohmann/json.hpp>

#include "bridge/ros2/message_types.hpp"
#include "support/catch.hpp"

using namespace rubicon;
using namespace rubicon::bridge;

namespace {

std::string ros2_message(std::string_view type, std::string_view text, double scale = 1) {
  const auto x = message_of(type, {"a.b", text, "f", scale, 3s + 5ns});
  return x ? x->dump() : "none";
}

std::string ros2_text_of(const std::string& type, const std::string& message, double scale = 1,
                         const std::string& member = {}, payload_type value = payload_type::text) {
  topic_subscription rule;
  rule.type = type;
  rule.scale = scale;
  rule.member = member;
  rule.value = value;
  return text_of_message(rule, nlohmann::json::parse(message)).value_or("none");
}

} // namespace

TEST_CASE("texts of tuples are messages of the types of ROS", "[bridge][ros2]") {
  CHECK(ros2_message("std_msgs/msg/Bool", "on") == R"({"data":true})");
  CHECK(ros2_message("std_msgs/msg/Bool", "0") == R"({"data":false})");
  CHECK(ros2_message("std_msgs/msg/Bool", "open") == "none");
  CHECK(ros2_message("std_msgs/msg/String", "a \"b\"") == R"({"data":"a \"b\""})");
  CHECK(ros2_message("std_msgs/msg/Float64", "2.5") == R"({"data":2.5})");
  CHECK(ros2_message("std_msgs/msg/Float64", "2.5", 2) == R"({"data":5.0})");
  CHECK(ros2_message("std_msgs/msg/Float64", "nan") == "none");
  CHECK(ros2_message("std_msgs/msg/Int64", "9223372036854775807") ==
        R"({"data":9223372036854775807})");
  CHECK(ros2_message("std_msgs/msg/Int64", "9223372036854775808") == "none");
  CHECK(ros2_message("std_msgs/msg/Int64", "-9223372036854775808") ==
        R"({"data":-9223372036854775808})");
  CHECK(ros2_message("std_msgs/msg/UInt8", "255") == R"({"data":255})");
  CHECK(ros2_message("std_msgs/msg/UInt8", "256") == "none");
  CHECK(ros2_message("std_msgs/msg/UInt8", "-1") == "none");
  CHECK(ros2_message("std_msgs/msg/Int8", "-128.4") == R"({"data":-128})");
  CHECK(ros2_message("std_msgs/msg/Int8", "-129") == "none");
  const std::string header = R"({"header":{"frame_id":"f","stamp":{"nanosec":5,"sec":3}},)";
  CHECK(ros2_message("sensor_msgs/msg/RelativeHumidity", "45") ==
        header + R"("relative_humidity":0.45})");
  CHECK(ros2_message("sensor_msgs/msg/Illuminance", "300") == header + R"("illuminance":300.0})");
  CHECK(ros2_message("sensor_msgs/msg/Range", "1.5") == header + R"("range":1.5})");
  CHECK(ros2_message("sensor_msgs/msg/BatteryState", "2900", 0.001) ==
        header + R"("present":true,"voltage":2.9})");
  CHECK(ros2_message("geometry_msgs/msg/Point", "1 2") == R"({"x":1.0,"y":2.0,"z":0.0})");
  CHECK(ros2_message("geometry_msgs/msg/Pose", "1.50 0.00 2.25") ==
        R"({"orientation":{"w":1.0,"x":0.0,"y":0.0,"z":0.0},)"
        R"("position":{"x":1.5,"y":0.0,"z":2.25}})");
  CHECK(ros2_message("geometry_msgs/msg/PoseStamped", "1 2 3").starts_with(header + R"("pose":)"));
  for (const auto* text : {"", "1", "1 2 3 4", "1  2", "unknown", "1 2 x"})
    CHECK(ros2_message("geometry_msgs/msg/Pose", text) == "none");
  CHECK(ros2_message("std_msgs/msg/Empty", "1") == "none");
}

TEST_CASE("messages of ROS are texts of tuples", "[bridge][ros2]") {
  CHECK(ros2_text_of("std_msgs/msg/Bool", R"({"data":true})") == "on");
  CHECK(ros2_text_of("std_msgs/msg/Bool", R"({"data":1})") == "none");
  CHECK(ros2_text_of("std_msgs/msg/Int64", R"({"data":-9007199254740993})") == "-9007199254740993");
  CHECK(ros2_text_of("std_msgs/msg/Float64", R"({"data":2.50})") == "2.5");
  CHECK(ros2_text_of("std_msgs/msg/Float64", R"({"data":null})") == "none");
  CHECK(ros2_text_of("std_msgs/msg/String", R"({"data":"kitchen"})") == "kitchen");
  CHECK(ros2_text_of("std_msgs/msg/String", R"({"data":")" + std::string(257, 'x') + "\"}") ==
        "none");
  CHECK(ros2_text_of("sensor_msgs/msg/RelativeHumidity", R"({"relative_humidity":0.5})") == "50");
  CHECK(ros2_text_of("geometry_msgs/msg/Pose", R"({"position":{"x":1,"y":2.5,"z":-3}})") ==
        "1 2.5 -3");
  CHECK(ros2_text_of("sensor_msgs/msg/Temperature", R"([1])") == "none");
}

TEST_CASE("a member of any message is the text of a tuple", "[bridge][ros2]") {
  const std::string scan = R"({"ranges":[0.5,1.25],"ok":false,"name":"front"})";
  CHECK(ros2_text_of("sensor_msgs/msg/LaserScan", scan, 100, "ranges.1", payload_type::number) ==
        "125");
  CHECK(ros2_text_of("sensor_msgs/msg/LaserScan", scan, 1, "ranges.2") == "none");
  CHECK(ros2_text_of("sensor_msgs/msg/LaserScan", scan, 1, "ranges.x") == "none");
  CHECK(ros2_text_of("sensor_msgs/msg/LaserScan", scan, 1, "ok", payload_type::flag) == "off");
  CHECK(ros2_text_of("sensor_msgs/msg/LaserScan", scan, 1, "name") == "front");
  CHECK(ros2_text_of("sensor_msgs/msg/LaserScan", scan, 1, "name", payload_type::number) == "none");
  CHECK(ros2_text_of("sensor_msgs/msg/LaserScan", scan, 1, "name.first") == "none");
}

TEST_CASE("blanks of a message are filled by what they name", "[bridge][ros2]") {
  const message_template made(R"({"a":["$x","$y"],"b":{"t":"$sec","s":"$text"},"c":"plain"})");
  REQUIRE(made.is_valid());
  const auto blanks = made.blanks();
  CHECK(blanks.size() == 4);
  const message_source source{"k", "1 2", {}, 1, 7s};
  const auto fill = [&](std::string_view name) { return value_of_blank(source, name); };
  const auto filled = made.filled(fill);
  REQUIRE(filled);
  CHECK(filled->dump() == R"({"a":[1.0,2.0],"b":{"s":"1 2","t":7},"c":"plain"})");
  CHECK(!message_template(R"({"a":"$number"})").filled(fill));
  CHECK(!message_template("[1]").is_valid());
  CHECK(!message_template("{").is_valid());
  CHECK(!message_template(R"({"a":)" + std::string(5000, '1') + '}').is_valid());
}

TEST_CASE("names of types and topics are those of ROS", "[bridge][ros2]") {
  CHECK(full_type("std_msgs/Bool", "msg") == "std_msgs/msg/Bool");
  CHECK(full_type("std_msgs/msg/Bool", "msg") == "std_msgs/msg/Bool");
  for (const auto* wrong :
       {"", "Bool", "std_msgs/", "/Bool", "std_msgs/srv/Bool", "a/b/c/d", "a b/C"})
    CHECK(!full_type(wrong, "msg"));
  CHECK(is_ros_name("/a/b_1"));
  CHECK(is_ros_name("kitchen/{1}/x", 1));
  for (const auto* wrong : {"", "/", "a//b", "a/", "1a", "a-b", "a/{1}", "a b", "a/{"})
    CHECK(!is_ros_name(wrong));
  CHECK(!is_ros_name("{2}", 1));
  CHECK(absolute_name("home", "a") == "/home/a");
  CHECK(absolute_name("/home", "a") == "/home/a");
  CHECK(absolute_name("home", "/a") == "/a");
  CHECK(absolute_name("", "a") == "/a");
}
