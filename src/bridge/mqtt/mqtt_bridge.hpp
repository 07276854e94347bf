// A bridge between tuples and an MQTT broker, with the announcements that Home Assistant follows.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "bridge/mqtt/expiry_list.hpp"
#include "bridge/mqtt/flood_limit.hpp"
#include "bridge/mqtt/mqtt_config.hpp"
#include "bridge/mqtt/publication_queue.hpp"
#include "bridge/table/object_table.hpp"
#include "bridge/table/waiting_messages.hpp"
#include "core/component.hpp"
#include "core/describe/fields.hpp"
#include "core/numbers/random.hpp"

namespace rubicon::bridge {

/// Subscribe to this topic, at quality of service 0.
struct subscription {
  std::string topic; ///< may have wildcards
};

struct unsubscription {
  std::string topic;
};

/// A message from the broker.
struct delivery {
  std::string_view topic;
  std::string_view payload;
  bool retained = false; ///< it was published before the subscription
};

using mqtt_output =
    std::variant<subscription, unsubscription, publication, components::publish, components::write>;
using mqtt_outputs = std::vector<mqtt_output>;

struct mqtt_counters {
  std::uint64_t connections = 0;
  std::uint64_t published = 0;
  std::uint64_t received = 0;
  std::uint64_t commands = 0;
  std::uint64_t commands_refused = 0; ///< not of the input's words and range, or too many in flight
  std::uint64_t writes_failed = 0;    ///< commands whose tuple could not be written
  std::uint64_t commands_unanswered = 0; ///< without outcome within command_timeout
  std::uint64_t commands_retained = 0;   ///< published before the subscription: never executed
  std::uint64_t unknown_topics = 0;      ///< of no object or input; dropped
  std::uint64_t oversized = 0;           ///< dropped
  /// of those beyond flood_limit: values and commands that a newer one has replaced, what is
  /// neither, and what had no room; dropped
  std::uint64_t flooded = 0;
  std::uint64_t bad_payloads = 0; ///< of topics that become tuples: not of their type; dropped
  std::uint64_t births = 0;       ///< of Home Assistant
  std::uint64_t removed = 0;      ///< objects whose announcement has been removed
};
RUBICON_FIELDS(mqtt_counters, connections, published, received, commands, commands_refused,
               writes_failed, commands_unanswered, commands_retained, unknown_topics, oversized,
               flooded, bad_payloads, births, removed);

/// Topics, all retained, below `base`:
///   bridge/state        {"state":"online"}; the last will of the connection says `offline`
///   bridge/devices      the names of all objects
///   NAME                readings and acknowledged inputs, as one JSON object
///   NAME/availability   {"state":"online"} while the status of the object is `active`
///   NAME/set            others publish a JSON object of inputs and their values
///   NAME/set/INPUT      others publish the value alone
///   NAME/get            others publish anything: NAME is published again
///
/// After a connection, and after each birth message of Home Assistant, all is published, after a
/// random delay: announcements, then availability, then states, then the state of the bridge. What
/// the broker has retained of objects that are not there is marked as not available, and removed
/// after `remove_after`.
///
/// A command is written to the tuple of its input. The state follows the outcome tuple, so a
/// command that fails does not change it. Retained commands are never executed: after a restart
/// they would be executed twice.
///
/// Of more messages than flood_limit allows in a second, the newest of each topic is read in the
/// next one.
class mqtt_bridge {
public:
  static constexpr std::size_t payload_max = 64 * 1024; ///< octets
  static constexpr std::size_t topic_max = 256;         ///< octets
  static constexpr std::size_t command_max = 1024;      ///< octets
  static constexpr std::size_t open_commands_max = 256;
  static constexpr duration jitter = 1s;
  static constexpr duration sweep_time = 5s; ///< for which retained topics are read
  static constexpr duration birth_pause = 10s;
  static constexpr duration list_pause = 1s; ///< before a changed list is published
  static constexpr duration command_timeout = 60s;

  mqtt_bridge() = default;
  mqtt_bridge(mqtt_config config, std::vector<class_model> classes, random_stream rng);

  [[nodiscard]] std::vector<std::string> watched() const { return table_.watched(); }
  [[nodiscard]] publication last_will() const;

  [[nodiscard]] mqtt_outputs on_tuple(const components::news& x, instant now);
  /// A write with this token has ended.
  /// @param cause empty: the owner of the tuple has received it
  [[nodiscard]] mqtt_outputs on_written(std::uint64_t token, std::string_view cause, instant now);

  [[nodiscard]] mqtt_outputs on_connected(instant now);
  void on_disconnected();
  [[nodiscard]] mqtt_outputs on_message(const delivery& x, instant now);

  [[nodiscard]] mqtt_outputs on_time(instant now); ///< harmless before deadline()
  [[nodiscard]] std::optional<instant> deadline() const;

  [[nodiscard]] bool is_connected() const { return connected_; }
  [[nodiscard]] const object_table& table() const { return table_; }
  [[nodiscard]] const mqtt_counters& counters() const { return counters_; }
  [[nodiscard]] const publication_queue& queue() const { return queue_; }

private:
  struct open_command {
    std::string name;
    std::string input;
    instant expires;
  };

  [[nodiscard]] std::string topic_of(std::string_view rest) const {
    return config_.base + '/' + std::string(rest);
  }
  [[nodiscard]] mqtt_outputs sent(instant now);
  void announce_all();
  void announce(const object& x);
  void accept(const delivery& x, instant now, mqtt_outputs& out);
  void accept_waiting(instant now, mqtt_outputs& out);
  /// Whether a message is a value or a command, of which the newest is needed.
  [[nodiscard]] bool has_value(std::string_view topic) const;
  void publish_availability(urgency how, std::string_view name, bool available);
  void publish_state(const object& x);
  void publish_list();
  void remove(const std::string& name);
  void plan_announcement(instant now);
  void on_birth(std::string_view payload, instant now);
  [[nodiscard]] bool convert(const delivery& x, mqtt_outputs& out);
  void on_own_topic(const delivery& x, std::string_view rest, instant now, mqtt_outputs& out);
  void on_announced(const delivery& x, instant now);
  /// @param of not nullptr, unless the message is retained
  void on_set(const delivery& x, const object* of, std::string_view input, instant now,
              mqtt_outputs& out);
  void command(const object& of, std::string_view input, std::string_view text, instant now,
               mqtt_outputs& out);

  mqtt_config config_;
  discovery_names names_;
  object_table table_;
  random_stream rng_;
  publication_queue queue_;
  bool connected_ = false;
  bool is_announced_ = false; ///< all was, since the connection
  std::optional<instant> announce_at_;
  std::optional<instant> sweep_ends_; ///< set: retained topics are being read
  std::optional<instant> list_at_;
  instant announced_{};                        ///< last time
  expiry_list removals_;                       ///< of objects, by name
  expiry_list unnamed_;                        ///< of announcements, by topic
  std::map<std::uint64_t, open_command> open_; ///< commands by token
  std::uint64_t last_token_ = 0;
  flood_limit flood_;
  waiting_messages waiting_; ///< for the next second
  mqtt_counters counters_;
};

} // namespace rubicon::bridge
