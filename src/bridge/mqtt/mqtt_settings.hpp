// All that a file says about a bridge to an MQTT broker.
#pragma once

#include <string>
#include <vector>

#include "bridge/mqtt/broker_config.hpp"
#include "bridge/mqtt/mqtt_config.hpp"
#include "bridge/mqtt/simulated_events.hpp"

namespace rubicon::bridge {

struct mqtt_settings {
  broker_config broker; ///< files as the configuration file names them
  std::string folder;   ///< that they are relative to
  mqtt_config bridge;
  std::vector<simulated_event> simulated; ///< in virtual time
  std::string place;                      ///< of [mqtt]: `home.toml:17`
};

} // namespace rubicon::bridge
