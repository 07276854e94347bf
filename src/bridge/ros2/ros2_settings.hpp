// All that a file says about a bridge to ROS 2.
#pragma once

#include <string>

#include "bridge/ros2/ros2_config.hpp"

namespace rubicon::bridge {

struct ros2_settings {
  std::string server = "127.0.0.1:9090"; ///< HOST:PORT of a rosbridge
  std::string path = "/";                ///< of its WebSocket
  ros2_config bridge;
};

} // namespace rubicon::bridge
