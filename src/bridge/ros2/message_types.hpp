// Which ROS messages a bridge makes of the texts of tuples, and what it reads of them.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "bridge/ros2/message_template.hpp"
#include "bridge/ros2/ros2_config.hpp"
#include "core/time.hpp"

namespace rubicon::bridge {

/// `std_msgs/Bool` and `std_msgs/msg/Bool` as the latter.
/// @param part what is between package and name: `msg` or `srv`
/// @returns nothing if it is no name of a type
[[nodiscard]] std::optional<std::string> full_type(std::string_view type, std::string_view part);

/// Whether it is a name of a topic or service: parts of letters, digits and `_`, not beginning with
/// a digit, between slashes; with `blanks` {1} to {blanks} may stand in it.
[[nodiscard]] bool is_ros_name(std::string_view name, std::size_t blanks = 0);

/// The name with its namespace: `/home/kitchen/fan`.
[[nodiscard]] std::string absolute_name(std::string_view name_space, std::string_view name);

/// Letters, digits and `_`: what a part of a key is in the name of a topic.
[[nodiscard]] std::string ros_part(std::string_view part);

/// Of the types that need neither `content` nor `member`.
[[nodiscard]] const std::vector<std::string>& known_types();

/// The blanks of a message that is published, see docs/bridges.md.
[[nodiscard]] const std::vector<std::string>& message_blanks();

/// What a message says beside its type.
struct message_source {
  std::string_view key;
  std::string_view text;
  std::string_view frame;
  double scale = 1;
  duration stamp{}; ///< since the epoch of ROS's time
};

/// A value of a blank; nothing if the text is not of that kind.
[[nodiscard]] std::optional<nlohmann::json> value_of_blank(const message_source& x,
                                                           std::string_view name);

/// The message of a type. @returns nothing if the text does not fit. @pre the type is known
[[nodiscard]] std::optional<nlohmann::json> message_of(std::string_view type,
                                                       const message_source& x);

/// A time as ROS has it: `{"sec": 1, "nanosec": 2}`.
[[nodiscard]] nlohmann::json time_message(duration x);

/// The text of the tuple. @returns nothing if the message is not of its type
[[nodiscard]] std::optional<std::string> text_of_message(const topic_subscription& rule,
                                                         const nlohmann::json& message);

} // namespace rubicon::bridge
