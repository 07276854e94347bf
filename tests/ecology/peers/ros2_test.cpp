// Bridges to ROS 2: with a simulated rosbridge, and with a fake one on loopback.
#include <string>
#include <string_view>

#include "ecology/ecology_files.hpp"
#include "support/catch.hpp"
#include "unit/bridge/fake_rosbridge.hpp"

using namespace rubicon;
using namespace rubicon::test;

namespace {

double ros2_figure(const report::run_report& x, std::string_view name) {
  for (const auto& program : x.programs) {
    if (program.kind != "ros2")
      continue;
    for (const auto& [each, value] : program.figures)
      if (each == name)
        return value;
  }
  return -1;
}

} // namespace

TEST_CASE("a home publishes its temperature in ROS 2", "[ecology][ros2]") {
  const auto x = run(example("bridged-home.toml"), 1);
  CHECK(x.violations.empty());
  CHECK(ros2_figure(x, "connections") == 1);
  CHECK(ros2_figure(x, "published") > 20);
  CHECK(ros2_figure(x, "bad values") == 0);
  CHECK(ros2_figure(x, "queue dropped") == 0);
  CHECK(run(example("bridged-home.toml"), 1).trace_hash == x.trace_hash);
}

TEST_CASE("a robot's tuples are topics of a real rosbridge, and a topic is its tuple",
          "[ecology][ros2]") {
  fake_rosbridge server;
  server.start();
  const auto x = run(describe(R"(
[ecology]
name = "bridged-robot"
mode = "wall"
duration = "3s"

[[peer]]
id = 1
name = "robot"

[[peer.apps]]
app = "goal"
outputs = [{ name = "battery", value = "100", every = "100ms", step = -1 }]
goals = [{ goal = "rest", states = [{ state = "resting", for = "1s" }] }]

[[ros2]]
peer = "robot"
server = "127.0.0.1:)" + std::to_string(server.port()) +
                              R"("
clock = "100ms"
publish = [{ key = "robot.battery", topic = "battery", type = "std_msgs/Int64" },
           { key = "seen", topic = "seen", type = "std_msgs/Int64" }]
subscribe = [{ topic = "/battery", type = "std_msgs/Int64", key = "seen" }]
)"));
  CHECK(x.violations.empty());
  CHECK(ros2_figure(x, "connections") == 1);
  CHECK(ros2_figure(x, "published") > 20);
  CHECK(ros2_figure(x, "tuples set") > 10);
  CHECK(ros2_figure(x, "clocks") > 10);
  CHECK(ros2_figure(x, "client oversized") == 0);
  CHECK(server.texts() > 40);
}
