// What payloads of MQTT messages mean, as far as no topic is needed for that.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "bridge/mqtt/mqtt_config.hpp"

namespace rubicon::bridge {

/// Of the topics that say whether the bridge or an object is there.
[[nodiscard]] std::string availability_payload(bool online);

/// The text of the tuple that a topic becomes; nothing if the payload is not of its type.
[[nodiscard]] std::optional<std::string> tuple_text(const topic_rule& rule,
                                                    std::string_view payload);

} // namespace rubicon::bridge
