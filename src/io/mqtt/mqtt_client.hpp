// A connection to an MQTT broker that is opened again whenever it ends, in a thread of its own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "core/describe/fields.hpp"
#include "core/time.hpp"

namespace rubicon::io {

struct mqtt_client_settings {
  std::string host;
  std::uint16_t port = 0;
  std::string client; ///< its id
  std::string user;   ///< empty: anonymous
  std::string password;
  bool tls = false;
  std::string authority;   ///< file with certificates that sign the broker's; empty: the system's
  std::string certificate; ///< file with the client's own; empty: none
  std::string key;         ///< file with its key
  std::string will_topic;  ///< what the broker publishes, retained, when the connection ends
  std::string will_payload;
};

struct mqtt_connected {};
/// Once until the next connection, however often it is tried; and once if the broker refuses it.
struct mqtt_disconnected {
  std::string cause;
};
struct mqtt_message {
  std::string topic;
  std::string payload;
  bool retained = false; ///< it was published before the subscription
};
using mqtt_event = std::variant<mqtt_connected, mqtt_disconnected, mqtt_message>;

struct mqtt_client_counters {
  std::uint64_t attempts = 0;    ///< to connect
  std::uint64_t refused = 0;     ///< of them, by the broker: a wrong password, or no permission
  std::uint64_t lost = 0;        ///< connections that have ended
  std::uint64_t sent = 0;        ///< publications and subscriptions
  std::uint64_t not_sent = 0;    ///< of a connection that has ended, or refused by the library
  std::uint64_t oversized = 0;   ///< received and dropped
  std::uint64_t queue_full = 0;  ///< connections closed since too much waited to be sent
  std::uint64_t read_pauses = 0; ///< while received messages waited for take()
};
RUBICON_FIELDS(mqtt_client_counters, attempts, refused, lost, sent, not_sent, oversized, queue_full,
               read_pauses);

/// Speaks MQTT 5 at quality of service 0. All it publishes is retained; it does not receive what it
/// publishes itself.
///
/// Messages that it receives wait for take(). While they are too many it does not read, so the
/// broker's own limits hold. If too many wait to be sent the connection is closed, so that after
/// the next one all is published anew.
///
/// The pause before another attempt doubles from 250 ms to 1.6 s, each to a quarter; it is 30 s
/// while the broker refuses this client, and not shorter than before if the connection lasted less
/// than `lasting`: two clients of the same id would end each other's.
class mqtt_client {
public:
  static constexpr std::size_t payload_max = 64 * 1024; ///< octets; the broker keeps longer ones
  static constexpr std::size_t inbox_max = 4096;        ///< events
  static constexpr std::size_t inbox_octets_max = 4 * 1024 * 1024;
  static constexpr std::size_t outbox_max = 20'000; ///< publications and subscriptions
  static constexpr duration pause_min = 250ms;
  static constexpr duration pause_max = 1600ms; ///< 2 s with a quarter
  static constexpr duration refused_pause = 30s;
  static constexpr duration lasting = 5s;

  /// Begins to connect. @param wake called when take() has something, from the client's thread
  mqtt_client(mqtt_client_settings settings, std::function<void()> wake);
  /// The broker publishes the will.
  ~mqtt_client();
  mqtt_client(const mqtt_client&) = delete;
  mqtt_client& operator=(const mqtt_client&) = delete;

  // Of the connection that take() has reported last; without effect once that has ended.
  void publish(std::string topic, std::string payload);
  void subscribe(std::string filter);
  void unsubscribe(std::string filter);

  [[nodiscard]] std::vector<mqtt_event> take();
  [[nodiscard]] mqtt_client_counters counters() const;

private:
  class state;
  std::shared_ptr<state> state_; ///< shared with the thread
};

} // namespace rubicon::io
