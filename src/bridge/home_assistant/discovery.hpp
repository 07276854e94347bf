// Objects as devices of Home Assistant: the document of MQTT device discovery, one for each object
// (https://www.home-assistant.io/integrations/mqtt/#mqtt-discovery).
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "bridge/table/object_table.hpp"

namespace rubicon::bridge {

/// What Home Assistant calls the kind of an entity.
enum class platform : std::uint8_t {
  sensor,
  binary_sensor,
  switch_,
  light,
  cover,
  fan,
  number,
  select,
  button,
};

/// As in the document: `binary_sensor`, `switch`.
[[nodiscard]] std::string_view to_string(platform x);
[[nodiscard]] std::optional<platform> platform_named(std::string_view name);

/// Platforms by `CLASS.FIELD` or `CLASS.INPUT`, instead of those that follow from units and words.
using platform_table = std::map<std::string, platform>;

[[nodiscard]] platform platform_of(const class_model& of, const field_model& x,
                                   const platform_table& given);
[[nodiscard]] platform platform_of(const class_model& of, const input_model& x,
                                   const platform_table& given);
/// Whether such an input can be of that platform: a switch needs the words `on` and `off`.
[[nodiscard]] bool fits(const input_model& x, platform as);
[[nodiscard]] bool fits(const field_model& x, platform as);

/// The topics that the document refers to.
struct discovery_names {
  std::string base;      ///< of all topics: `rubicon`
  std::string discovery; ///< `homeassistant`
};

/// `rubicon_kitchen_fan`: of `_`, `.` and names the same for no two objects.
[[nodiscard]] std::string device_id(const discovery_names& names, std::string_view object);

/// `homeassistant/device/ID/config`
[[nodiscard]] std::string discovery_topic(const discovery_names& names, std::string_view object);

/// @param called the name of the device
/// @returns JSON on one line
[[nodiscard]] std::string discovery_document(const discovery_names& names, const class_model& of,
                                             const object& x, const platform_table& given,
                                             std::string_view called);

/// What `BASE/NAME` has: readings, acknowledged inputs and outcomes of requests, as one JSON
/// object.
[[nodiscard]] std::string state_document(const class_model& of, const object& x);

} // namespace rubicon::bridge
