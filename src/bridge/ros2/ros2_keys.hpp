// The keys of what a file may say about a bridge to ROS 2.
#pragma once

#include "bridge/ros2/message_template.hpp"
#include "bridge/ros2/ros2_config.hpp"
#include "bridge/ros2/ros2_settings.hpp"
#include "core/describe/keys.hpp"

namespace rubicon::bridge {

inline constexpr std::size_t ros_name_max = 256; ///< octets

inline auto keys_of(const ros2_settings*) {
  return keys::of(
      keys::optional("server", &ros2_settings::server, keys::text{255},
                     {"where the rosbridge is, in wall time; in virtual time it is simulated", "",
                      "text `\"HOST:PORT\"`; `\"wss://HOST:PORT\"`: with TLS"}),
      keys::optional("path", &ros2_settings::path, keys::text{255}, "of its WebSocket"),
      keys::optional("ca_file", &ros2_settings::ca_file, keys::text{4096},
                     {"file with the certificates that sign the server's, as PEM; needs `wss://`",
                      "those of the system"}),
      keys::optional("verify", &ros2_settings::verify, keys::flag{},
                     "with `wss://`: the server must have a certificate for its host name that "
                     "`ca_file`, or the system, trusts"));
}

inline auto keys_of(const ros2_config*) {
  return keys::of(
      keys::optional("namespace", &ros2_config::name_space, keys::text{ros_name_max},
                     {"of topics and services without a leading `/`", "none"}),
      keys::optional("clock", &ros2_config::clock_every, keys::time_span{1ms, 10s},
                     {"period of `/clock`, with the ecology's time, for nodes with `use_sim_time`; "
                      "headers have this time, too",
                      "`/clock` is not published, and headers have the time of the system"}));
}

inline auto scale_key() {
  return keys::real{-1e12, 1e12};
}

inline auto keys_of(const topic_publication*) {
  return keys::of(
      keys::required("key", &topic_publication::key, keys::tuple_key{true},
                     "of the tuples, of any peer"),
      keys::required("topic", &topic_publication::topic, keys::text{ros_name_max},
                     "where they are published; `{1}` stands for what the first `*` of `key` is"),
      keys::required("type", &topic_publication::type, keys::text{ros_name_max},
                     {"type of the messages", "", "text `\"PACKAGE/NAME\"`"}),
      keys::optional("message", &topic_publication::content,
                     keys::text{message_template::octets_max},
                     {"a message as JSON with [blanks](bridges.md#messages)",
                      "that of the type, see [bridges.md](bridges.md#messages)"}),
      keys::optional("frame", &topic_publication::frame, keys::text{100},
                     {"`frame_id` of headers", "empty"}),
      keys::optional("scale", &topic_publication::scale, scale_key(),
                     "numbers are multiplied by it"),
      keys::optional("every", &topic_publication::every, keys::time_span{0s, 1h},
                     "least time between two messages of a topic"),
      keys::optional("latch", &topic_publication::latch, keys::flag{},
                     "later subscribers receive the newest message, also after a restart of the "
                     "server"),
      keys::optional("queue", &topic_publication::queue, keys::whole<std::uint32_t>{1, 100},
                     "messages of a topic that wait here, and at the publisher in ROS; a newer one "
                     "replaces the oldest"));
}

inline keys::word<payload_type> payload_words() {
  return {{{"text", payload_type::text},
           {"number", payload_type::number},
           {"flag", payload_type::flag}}};
}

inline auto keys_of(const topic_subscription*) {
  return keys::of(
      keys::required("topic", &topic_subscription::topic, keys::text{ros_name_max},
                     "that others publish"),
      keys::required("type", &topic_subscription::type, keys::text{ros_name_max},
                     {"type of its messages", "", "text `\"PACKAGE/NAME\"`"}),
      keys::required("key", &topic_subscription::key, keys::tuple_key{},
                     "of the tuple of the bridge's peer that has the newest message"),
      keys::optional("member", &topic_subscription::member, keys::text{100},
                     {"part of the message that the tuple has, as in `pose.position.x`",
                      "that of the type, see [bridges.md](bridges.md#messages)"}),
      keys::optional("value", &topic_subscription::value, payload_words(),
                     "what `member` must be: a text of up to 256 octets, a number, or a truth "
                     "value, which becomes `on` or `off`. Others are dropped and counted"),
      keys::optional("scale", &topic_subscription::scale, scale_key(),
                     "numbers are multiplied by it"),
      keys::optional("throttle", &topic_subscription::throttle, keys::time_span{0s, 1h},
                     "least time between two messages that the server sends"),
      keys::optional("queue", &topic_subscription::queue, keys::whole<std::uint32_t>{1, 1000},
                     "messages that wait at the server meanwhile"));
}

inline auto keys_of(const offered_service*) {
  return keys::of(
      keys::required("service", &offered_service::service, keys::text{ros_name_max},
                     "its name in ROS"),
      keys::optional("type", &offered_service::type, keys::text{ros_name_max},
                     {"its type", "", "text `\"PACKAGE/NAME\"`"}),
      keys::required("key", &offered_service::key, keys::tuple_key{},
                     "of the tuple that a call writes at its owner: an input of an object, a goal"),
      keys::optional(
          "outcome", &offered_service::outcome, keys::tuple_key{},
          {"of the tuple with the outcome: the value, a blank, one word", "`KEY.outcome`"}),
      keys::optional("on", &offered_service::on, keys::text{100},
                     "what a call of `SetBool` writes for true"),
      keys::optional("off", &offered_service::off, keys::text{100}, "and for false"),
      keys::optional("value", &offered_service::value, keys::text{payload_text_max},
                     {"what any call writes, whatever it says", "that of the request"}),
      keys::optional("member", &offered_service::member, keys::text{100},
                     {"part of the request that is written", "`data`, a truth value"}),
      keys::optional("response", &offered_service::content,
                     keys::text{message_template::octets_max},
                     {"the answer as JSON with the blanks `$success` and `$message`",
                      "that of `SetBool` and `Trigger`"}),
      keys::optional("timeout", &offered_service::timeout, keys::time_span{10ms, 1h},
                     "a call without outcome is answered after so long"));
}

inline auto keys_of(const requested_service*) {
  return keys::of(
      keys::required("key", &requested_service::key, keys::tuple_key{},
                     "of the tuple of the bridge's peer whose new values are requests; what became "
                     "of one is in `KEY.outcome`"),
      keys::required("service", &requested_service::service, keys::text{ros_name_max},
                     "the service of others"),
      keys::required("type", &requested_service::type, keys::text{ros_name_max},
                     {"its type", "", "text `\"PACKAGE/NAME\"`"}),
      keys::optional("request", &requested_service::content,
                     keys::text{message_template::octets_max},
                     {"a request as JSON with [blanks](bridges.md#messages)",
                      "`{}`, with `SetBool` `{\"data\": \"$flag\"}`"}),
      keys::optional("timeout", &requested_service::timeout, keys::time_span{10ms, 1h},
                     "a request without answer ends after so long"));
}

} // namespace rubicon::bridge
