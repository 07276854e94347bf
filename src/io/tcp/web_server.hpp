// A page for browsers, and what it and the program say to each other while it is open: HTTP and
// WebSocket (Boost.Beast), on a thread of their own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/time.hpp"

namespace rubicon::io {

/// What a browser may fetch.
struct web_file {
  std::string type; ///< `text/html; charset=utf-8`
  std::string content;
};

/// The program's end of one WebSocket. Called by the server's thread alone. What it throws ends
/// this WebSocket, and nothing else.
class web_session {
public:
  web_session() = default;
  virtual ~web_session() = default;
  web_session(const web_session&) = delete;
  web_session& operator=(const web_session&) = delete;

  /// The page has said this; the answer is said to it. Nothing more is read before it has left.
  [[nodiscard]] virtual std::string on_text(std::string_view text) = 0;

  /// What is to be sent to the page unasked, if anything; called every web_server::news_every, but
  /// not while something is still being sent to the page. So a slow browser receives less, and
  /// nothing ever waits for it.
  [[nodiscard]] virtual std::optional<std::string> news() = 0;
};

struct web_site {
  std::string address = "127.0.0.1"; ///< IPv4, at which it listens
  std::uint16_t port = 0;            ///< 0: the system chooses
  /// Names under which browsers may reach it, in lower case, beside those of this computer: of a
  /// host, or of a proxy in front.
  std::vector<std::string> hosts = {};
  /// First part of each path: requests without it get 404. Empty: paths have no such part.
  std::string token;
  std::map<std::string, web_file> files; ///< by name, `` is the page; at `/TOKEN/NAME`
  /// What a name that `files` lacks stands for at this moment, if for anything; may be empty.
  /// Called by the server's thread.
  std::function<std::optional<web_file>(std::string_view name)> on_request;
  std::string socket_name = "live";                         ///< of the WebSocket, likewise
  std::function<std::unique_ptr<web_session>()> on_session; ///< may be empty: there is none
  /// Called every web_server::news_every, by the server's thread; may be empty.
  std::function<void()> on_time;
};

/// Serves a site from open() on until it is destroyed, which ends all connections.
///
/// Refused: paths without the token (404), a `Host` that is neither of this computer, an address
/// nor one of `hosts` (403: another site's name that leads here), a WebSocket of a page that is
/// neither this server's nor of one of `hosts` (`Origin`, 403), and other methods than GET and HEAD
/// (405). Pages may run their own files and nothing else (Content-Security-Policy).
class web_server {
public:
  /// Beyond, one that has not shown the token is closed for the next, the oldest first.
  static constexpr std::size_t connections_max = 256;
  static constexpr std::size_t question_octets_max = 65'536; ///< longer ones end the WebSocket
  static constexpr std::size_t request_octets_max = 16'384;  ///< of the head of a request
  static constexpr duration patience = 30s; ///< with who says nothing, or does not read
  static constexpr duration news_every = 250ms;

  /// @returns the server, or why there is none: `cannot listen on 127.0.0.1:80: ...`
  [[nodiscard]] static std::variant<web_server, std::string> open(web_site site);

  ~web_server();
  web_server(web_server&&) noexcept;
  web_server& operator=(web_server&&) noexcept;

  [[nodiscard]] std::uint16_t port() const;

private:
  struct state;
  explicit web_server(std::unique_ptr<state> x);

  std::unique_ptr<state> state_;
};

} // namespace rubicon::io
