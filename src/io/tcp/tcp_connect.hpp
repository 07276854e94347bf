// Opening a TCP connection without waiting for it (LNK-07).
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <variant>

#include "core/time.hpp"
#include "io/loop.hpp"
#include "io/tcp/tcp_stream.hpp"

namespace rubicon::io {

/// Whether an attempt failed, with these words, because nobody has the name of its host; not
/// because nobody could be asked.
[[nodiscard]] bool is_unknown_host(std::string_view why);

/// One attempt: looks the name up, tries each of its IPv4 addresses in turn, and calls back once,
/// on the loop's thread, never from within the constructor. Destroying it gives the attempt up
/// without a call.
class tcp_connect {
public:
  /// The connection, not yet started, or why there is none: `localhost:9: Connection refused`. May
  /// destroy the attempt.
  using callback = std::function<void(std::variant<tcp_stream, std::string>)>;

  /// @param host name or IPv4 address. A name is looked up on a thread of Asio's; a lookup that is
  /// given up may hold up the end of the loop as long as the system's resolver takes.
  tcp_connect(loop& where, std::string host, std::uint16_t port, duration timeout,
              callback on_result);
  ~tcp_connect();
  tcp_connect(tcp_connect&&) noexcept;
  tcp_connect& operator=(tcp_connect&&) noexcept;

private:
  struct state;
  std::shared_ptr<state> state_;
};

} // namespace rubicon::io
