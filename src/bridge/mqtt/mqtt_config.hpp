// The configuration of a bridge to an MQTT broker.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "bridge/home_assistant/discovery.hpp"
#include "bridge/table/payload.hpp"
#include "core/time.hpp"

namespace rubicon::bridge {

/// An MQTT topic as an own tuple.
struct topic_rule {
  std::string topic; ///< no wildcards
  std::string key;   ///< of the tuple
  payload_type type = payload_type::text;
  std::string member; ///< of the JSON object that the payload is; empty: the payload itself
};

struct mqtt_config {
  std::string base = "rubicon";            ///< first part of all own topics
  bool home_assistant = true;              ///< objects are announced to it
  std::string discovery = "homeassistant"; ///< first part of its topics
  duration remove_after =
      10min;                ///< an object without tuples for so long is removed from the broker
  std::uint32_t rate = 190; ///< messages that the bridge publishes in any second, at most
  std::vector<topic_rule> topics;
  platform_table platforms;
  std::map<std::string, std::string> labels; ///< of objects, by name in lower case
};

} // namespace rubicon::bridge
