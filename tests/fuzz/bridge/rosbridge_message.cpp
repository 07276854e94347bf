// What a rosbridge sends, line by line: it sets only tuples that are listed, and leaves nothing
// behind.
#include <cstdint>
#include <string_view>
#include <variant>

#include "bridge/ros2/ros2_bridge.hpp"
#include "core/overloads.hpp"
#include "fuzz/require.hpp"

namespace {

using namespace rubicon;

bridge::ros2_config listed() {
  bridge::ros2_config x;
  bridge::topic_subscription pose;
  pose.topic = "/pose";
  pose.key = "pose";
  pose.type = "geometry_msgs/msg/PoseStamped";
  x.subscriptions.push_back(pose);
  bridge::topic_subscription part;
  part.topic = "/scan";
  part.key = "scan";
  part.type = "sensor_msgs/msg/LaserScan";
  part.member = "ranges.0";
  part.value = bridge::payload_type::number;
  x.subscriptions.push_back(part);
  bridge::offered_service fan;
  fan.service = "/fan";
  fan.key = "fan.switch";
  x.offers.push_back(fan);
  bridge::requested_service lamp;
  lamp.key = "lamp";
  lamp.service = "/lamp";
  lamp.type = "std_srvs/srv/SetBool";
  x.requests.push_back(lamp);
  return x;
}

void check(const bridge::ros2_outputs& all) {
  for (const auto& each : all)
    std::visit(overloads{[](const components::publish& x) {
                           require(x.key == "pose" || x.key == "scan" || x.key == "lamp.outcome");
                           require(x.value.size() <= bridge::payload_text_max);
                         },
                         [](const components::write& x) { require(x.key == "fan.switch"); },
                         [](const bridge::ros2_text& x) { require(!x.text.empty()); },
                         [](const bridge::open_connection&) { require(false); }},
               each);
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  bridge::ros2_bridge x(listed(), random_stream(1));
  static_cast<void>(x.start(instant{}));
  check(x.on_connected(instant{}));
  check(x.on_tuple({1, peer_id{1}, "fan.switch", "off", false}, instant{}));
  check(x.on_tuple({3, peer_id{2}, "lamp", "on", false}, instant{}));
  std::string_view rest(reinterpret_cast<const char*>(data), size);
  while (!rest.empty()) {
    const auto end = rest.find('\n');
    check(x.on_text(rest.substr(0, end), instant{}));
    rest = end == std::string_view::npos ? std::string_view() : rest.substr(end + 1);
  }
  check(x.on_time(instant{} + 1h));
  require(!x.deadline());
  const auto& counters = x.services();
  require(counters.calls == counters.calls_succeeded + counters.calls_failed);
  require(counters.requests == counters.requests_succeeded + counters.requests_failed);
  return 0;
}
