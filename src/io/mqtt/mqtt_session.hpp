// For files of this room only: one connection of libmosquitto, whatever its calls are about.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "io/mqtt/mqtt_client.hpp"

struct mosquitto;
struct mosquitto_message;

namespace rubicon::io {

/// What is to be sent.
struct mqtt_request {
  enum class kind : std::uint8_t { publish, subscribe, unsubscribe };
  kind what = kind::publish;
  std::string topic;
  std::string payload;
};

/// One attempt to connect, and the connection that comes of it. For one thread.
class mqtt_session {
public:
  explicit mqtt_session(std::function<void(mqtt_message)> on_message)
      : on_message_(std::move(on_message)) {}
  ~mqtt_session();
  mqtt_session(const mqtt_session&) = delete;
  mqtt_session& operator=(const mqtt_session&) = delete;

  /// Waits for the connection of TCP. @returns why there is none; empty: the broker is asked
  [[nodiscard]] std::string open(const mqtt_client_settings& x);
  /// The broker publishes the will. Waits for nothing.
  void close();

  /// Whether the broker has accepted the client.
  [[nodiscard]] bool is_connected() const { return connected_; }
  [[nodiscard]] bool is_refused() const { return refused_; }
  /// Whether another request can be sent without waiting.
  [[nodiscard]] bool is_free() const;
  /// @returns whether it was sent
  [[nodiscard]] bool send(const mqtt_request& x);

  /// Waits until something is received, if `reads`, or can be sent, or `wake` can be read, and does
  /// what is to be done. @returns why the connection has ended; empty: it has not
  [[nodiscard]] std::string serve(int wake, bool reads);

  [[nodiscard]] std::uint64_t oversized() const { return oversized_; }

private:
  void on_answer(int reason);
  void on_message(const ::mosquitto_message& x);
  [[nodiscard]] bool wants_write() const;
  [[nodiscard]] int read(bool reads);
  [[nodiscard]] std::string set_up(const mqtt_client_settings& x);

  std::function<void(mqtt_message)> on_message_;
  ::mosquitto* client_ = nullptr;
  bool connected_ = false;
  bool refused_ = false;
  std::string refusal_;
  std::uint64_t oversized_ = 0;
};

} // namespace rubicon::io
