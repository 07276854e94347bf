// A bridge between tuples and ROS 2, by the rosbridge protocol 2.0.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "bridge/ros2/ros2_config.hpp"
#include "bridge/ros2/ros2_services.hpp"
#include "bridge/ros2/topic_outbox.hpp"
#include "bridge/ros2/topic_rules.hpp"
#include "bridge/table/per_second_limit.hpp"
#include "bridge/table/waiting_messages.hpp"
#include "core/component.hpp"
#include "core/describe/fields.hpp"
#include "core/numbers/random.hpp"
#include "core/numbers/reconnect_pause.hpp"

namespace rubicon::bridge {

/// Connect to the server; on_connected() or on_disconnected() follows.
struct open_connection {};

/// A message for the server, in one WebSocket message; on_sent() follows.
struct ros2_text {
  std::string text;
};

using ros2_output =
    std::variant<open_connection, ros2_text, components::publish, components::write>;
using ros2_outputs = std::vector<ros2_output>;

struct ros2_counters {
  std::uint64_t connections = 0;
  std::uint64_t failures = 0;    ///< connections that have ended, and attempts that failed
  std::uint64_t published = 0;   ///< messages, with those that their queues have dropped
  std::uint64_t clocks = 0;      ///< messages of `/clock`
  std::uint64_t bad_values = 0;  ///< texts of tuples that do not fit the type; not published
  std::uint64_t unconnected = 0; ///< values while there was no connection; not published then
  std::uint64_t topics_full = 0; ///< values of more topics than there may be; not published
  std::uint64_t received = 0;    ///< messages of the server
  std::uint64_t tuples_set = 0;
  std::uint64_t bad_messages = 0; ///< of topics: not of their type; dropped
  std::uint64_t unlisted = 0;     ///< of topics and services that the file does not list; dropped
  std::uint64_t malformed = 0;    ///< no rosbridge message; dropped
  std::uint64_t oversized = 0;    ///< dropped
  /// of those beyond received_max in a second: values that a newer one has replaced, what is no
  /// value, and what had no room; dropped
  std::uint64_t flooded = 0;
  std::uint64_t server_errors = 0; ///< that the server has reported
};
RUBICON_FIELDS(ros2_counters, connections, failures, published, clocks, bad_values, unconnected,
               topics_full, received, tuples_set, bad_messages, unlisted, malformed, oversized,
               flooded, server_errors);

/// Only topics and services that the configuration lists are advertised, subscribed to, set, and
/// called. After each connection all is advertised and subscribed to again, and the newest message
/// of each topic that is latched is published again.
///
/// Of more than received_max messages in a second the newest value of each topic is read in the
/// next one.
///
///   opening --on_connected--> open --on_disconnected--> pausing --pause is over--> opening
///      |                                                   ^
///      +-------------------on_disconnected-----------------+
class ros2_bridge {
public:
  static constexpr std::size_t message_max = 64 * 1024; ///< octets
  static constexpr std::size_t received_max = 5000;     ///< messages of a second
  static constexpr std::size_t in_flight_max = 64; ///< messages that are handed over and not sent
  static constexpr duration pause_min = 250ms;     ///< before another attempt to connect,
  static constexpr duration pause_max = 8s;        ///< to a quarter

  ros2_bridge() = default;
  /// @param epoch added to ecology time in the headers of messages, if `/clock` is not published
  ros2_bridge(ros2_config config, random_stream rng, duration epoch = {});

  /// @param self whose kernel it uses
  [[nodiscard]] std::vector<components::watch> watched(peer_id self) const;

  [[nodiscard]] ros2_outputs start(instant now);
  [[nodiscard]] ros2_outputs on_tuple(const components::news& x, instant now);
  /// A write with this token has ended.
  /// @param cause empty: the owner of the tuple has received it
  [[nodiscard]] ros2_outputs on_written(std::uint64_t token, std::string_view cause, instant now);

  [[nodiscard]] ros2_outputs on_connected(instant now);
  /// A connection has ended, or an attempt has failed.
  [[nodiscard]] ros2_outputs on_disconnected(instant now);
  [[nodiscard]] ros2_outputs on_text(std::string_view text, instant now);
  /// So many messages have been sent.
  [[nodiscard]] ros2_outputs on_sent(std::size_t count, instant now);

  [[nodiscard]] ros2_outputs on_time(instant now); ///< harmless before deadline()
  [[nodiscard]] std::optional<instant> deadline() const;

  [[nodiscard]] bool is_connected() const { return state_ == state::open; }
  [[nodiscard]] const ros2_counters& counters() const { return counters_; }
  [[nodiscard]] const ros2_service_counters& services() const { return services_.counters(); }
  [[nodiscard]] const topic_outbox& outbox() const { return outbox_; }

private:
  enum class state : std::uint8_t { pausing, opening, open };

  void send(const nlohmann::json& x, ros2_outputs& out);
  void perform(ros2_service_outputs todo, ros2_outputs& out);
  void send_waiting(instant now, ros2_outputs& out);
  void publish_clock(instant now);
  void read(std::string_view text, instant now, ros2_outputs& out);
  void read_waiting(instant now, ros2_outputs& out);
  void on_operation(const nlohmann::json& x, instant now, ros2_outputs& out);
  void on_message(const nlohmann::json& x, ros2_outputs& out);
  [[nodiscard]] duration stamp(instant now) const;

  ros2_config config_;
  random_stream rng_;
  duration epoch_{};
  topic_rules topics_;
  ros2_services services_;
  topic_outbox outbox_;
  std::size_t clock_topic_ = 0; ///< in the outbox
  state state_ = state::pausing;
  std::optional<instant> retry_at_;
  std::optional<instant> clock_at_;
  reconnect_pause pause_{pause_min, pause_max};
  std::size_t in_flight_ = 0;
  per_second_limit flood_{received_max};
  waiting_messages waiting_; ///< of topics that are subscribed to
  ros2_counters counters_;
};

/// For the report.
[[nodiscard]] components::figures figures_of(const ros2_bridge& x);

} // namespace rubicon::bridge
