// All that a file says about a bridge to an MQTT broker.
#pragma once

#include <string>

#include "bridge/mqtt/broker_config.hpp"
#include "bridge/mqtt/mqtt_config.hpp"

namespace rubicon::bridge {

struct mqtt_settings {
  broker_config broker; ///< files as the configuration file names them
  std::string folder;   ///< that they are relative to
  mqtt_config bridge;
};

} // namespace rubicon::bridge
