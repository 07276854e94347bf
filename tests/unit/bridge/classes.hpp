// Two proxy classes as bridges see them, and the tuples of their objects.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bridge/mqtt/mqtt_bridge.hpp"
#include "bridge/table/class_model.hpp"
#include "core/component.hpp"

namespace rubicon::test {

inline constexpr peer_id bridged_owner{30};

inline std::vector<bridge::class_model> bridged_classes() {
  bridge::class_model climate{"climate", "kitchen.*", {}, {}};
  climate.fields = {{"temperature", "C", {}}, {"door", "", {"closed", "open"}}};
  bridge::class_model fan{"fan", "kitchen.*", {}, {}};
  fan.fields = {{"rssi", "dBm", {}}};
  fan.inputs = {{"switch", "", {"on", "off"}},
                {"speed", "%", {}, bridge::number_range{0, 100'000, 1}}};
  return {climate, fan};
}

inline components::news bridged_news(const std::string& key, const std::string& text,
                                     peer_id owner = bridged_owner) {
  return {0, owner, key, text, false};
}

inline components::news bridged_deletion(const std::string& key) {
  return {0, bridged_owner, key, {}, true};
}

} // namespace rubicon::test
