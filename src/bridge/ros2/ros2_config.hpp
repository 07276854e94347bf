// The configuration of a bridge to ROS 2.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bridge/table/payload.hpp"
#include "core/time.hpp"

namespace rubicon::bridge {

/// Tuples as messages of a ROS topic.
struct topic_publication {
  std::string key;         ///< of the tuples, whoever owns them; may have `*` parts
  std::string topic;       ///< {1} stands for the first `*` part
  std::string type;        ///< of its messages: `std_msgs/msg/Float64`
  std::string content;     ///< a message as JSON, see message_template; empty: that of the type
  std::string frame;       ///< `frame_id` of headers
  double scale = 1;        ///< numbers are multiplied by it
  duration every{};        ///< least time between two messages of a topic
  bool latch = true;       ///< the newest message is sent to later subscribers
  std::uint32_t queue = 1; ///< messages of a topic that wait; a newer one replaces the oldest
};

/// A ROS topic as an own tuple.
struct topic_subscription {
  std::string topic;
  std::string key; ///< of the tuple
  std::string type;
  std::string member; ///< of the message: `pose.position.x`; empty: that of the type
  payload_type value = payload_type::text; ///< what the member is
  double scale = 1;                        ///< numbers are multiplied by it
  duration throttle{};                     ///< least time between two messages
  std::uint32_t queue = 1;                 ///< messages that wait at the server
};

/// A ROS service that writes a tuple, and answers with what came of it.
struct offered_service {
  std::string service;
  std::string type = "std_srvs/srv/SetBool";
  std::string key;       ///< of the tuple, whoever owns it; its outcome is in `KEY.outcome`
  std::string outcome;   ///< key of the outcome; empty: `KEY.outcome`
  std::string member;    ///< of the request; empty: `data`, a flag, of SetBool; nothing of Trigger
  std::string value;     ///< what Trigger writes
  std::string on = "on"; ///< what SetBool writes for true
  std::string off = "off"; ///< and for false
  std::string content;     ///< the answer as JSON, see message_template; empty: that of SetBool
  duration timeout = 10s;
};

/// An own tuple whose new values are requests to a ROS service.
struct requested_service {
  std::string key; ///< outcomes are in `KEY.outcome`
  std::string service;
  std::string type;
  std::string content; ///< the request as JSON, see message_template; empty: SetBool or Trigger
  duration timeout = 10s;
};

struct ros2_config {
  std::string name_space;              ///< of names without a leading `/`; empty: none
  std::optional<duration> clock_every; ///< period of `/clock`; nothing: it is not published
  std::vector<topic_publication> publications;
  std::vector<topic_subscription> subscriptions;
  std::vector<offered_service> offers;
  std::vector<requested_service> requests;
};

} // namespace rubicon::bridge
