// The client's end of a WebSocket (Boost.Beast), on a thread of its own.
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

struct web_client_settings {
  std::string host; ///< name or IPv4 address
  std::uint16_t port = 0;
  std::string path = "/";
  bool tls = false;
  std::string ca_file = {}; ///< certificates that sign the server's, as PEM; empty: the system's
  bool verify = true;       ///< with TLS, the server's certificate must be good and for `host`
};

struct web_connected {};
/// The attempt has failed, or the connection has ended. Nothing follows before connect().
struct web_disconnected {
  std::string cause;
};
struct web_message {
  std::string text;
};
/// So many messages more have been written to the connection.
struct web_sent {
  std::size_t count = 0;
};
using web_event = std::variant<web_connected, web_disconnected, web_message, web_sent>;

struct web_client_counters {
  std::uint64_t attempts = 0;    ///< to connect
  std::uint64_t sent = 0;        ///< messages
  std::uint64_t not_sent = 0;    ///< messages of a connection that has ended
  std::uint64_t received = 0;    ///< messages
  std::uint64_t oversized = 0;   ///< received messages longer than message_max; dropped
  std::uint64_t not_text = 0;    ///< binary messages; dropped
  std::uint64_t queue_full = 0;  ///< connections closed since too much waited to be sent
  std::uint64_t read_pauses = 0; ///< while received messages waited for take()
};
RUBICON_FIELDS(web_client_counters, attempts, sent, not_sent, received, oversized, not_text,
               queue_full, read_pauses);

/// Messages that it receives wait for take(). While they are too many it does not read. If too many
/// wait to be sent, the connection is closed. A server that does not answer within 10 s, or from
/// which nothing comes for 30 s, not even an answer to a ping, is given up.
class web_client {
public:
  static constexpr std::size_t message_max = 64 * 1024; ///< octets; the rest of a longer one is
                                                        ///< read and dropped,
  static constexpr std::size_t message_end_max =
      64 * 1024 * 1024; ///< up to this: one that is still longer ends the connection
  static constexpr std::size_t inbox_max = 4096; ///< events
  static constexpr std::size_t inbox_octets_max = 4 * 1024 * 1024;
  static constexpr std::size_t outbox_max = 4096; ///< messages
  static constexpr duration answer_max = 10s;
  static constexpr duration silence_max = 30s;

  /// Connects to nothing yet. @param wake called when take() has something, from the client's
  /// thread
  web_client(web_client_settings settings, std::function<void()> wake);
  /// Ends the connection. A lookup of a name is waited for.
  ~web_client();
  web_client(const web_client&) = delete;
  web_client& operator=(const web_client&) = delete;

  /// Tries once. Without effect while there is a connection or an attempt.
  void connect();
  /// Over the connection that take() has reported last; without effect once that has ended.
  void send(std::string text);

  [[nodiscard]] std::vector<web_event> take();
  [[nodiscard]] web_client_counters counters() const;

private:
  class state;
  std::unique_ptr<state> state_;
};

} // namespace rubicon::io
