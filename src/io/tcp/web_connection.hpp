// For files of this room only: one attempt of a WebSocket, and the connection that comes of it.
#pragma once

#include <memory>
#include <string>

#include <boost/asio/io_context.hpp>

#include "io/tcp/web_boxes.hpp"
#include "io/tcp/web_client.hpp"

namespace rubicon::io {

/// For one thread. Handlers keep it alive.
class web_connection {
public:
  web_connection() = default;
  virtual ~web_connection() = default;
  web_connection(const web_connection&) = delete;
  web_connection& operator=(const web_connection&) = delete;

  virtual void begin() = 0;
  virtual void send_waiting() = 0;
  virtual void read() = 0; ///< once more after a pause
  virtual void end(std::string cause) = 0;
  [[nodiscard]] virtual bool is_over() const = 0;
};

/// Over TCP, or over TLS as the settings want it. All must outlive it.
[[nodiscard]] std::shared_ptr<web_connection> make_web_connection(boost::asio::io_context& context,
                                                                  web_boxes& boxes,
                                                                  const web_client_settings& to);

} // namespace rubicon::io
