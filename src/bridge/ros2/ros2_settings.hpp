// All that a file says about a bridge to ROS 2.
#pragma once

#include <string>

#include "bridge/ros2/ros2_config.hpp"

namespace rubicon::bridge {

struct ros2_settings {
  std::string server = "127.0.0.1:9090"; ///< parse_rosbridge_place() knows it
  std::string path = "/";                ///< of its WebSocket
  std::string ca_file; ///< certificates that sign the server's; empty: the system's. As it is named
  bool verify = true;  ///< with TLS, the server proves who it is
  std::string folder;  ///< that `ca_file` is relative to
  std::string place;   ///< of [[ros2]]: `home.toml:17`
  ros2_config bridge;
};

} // namespace rubicon::bridge
