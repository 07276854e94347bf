// A TCP port that others connect to (peis-wire.md 3.1).
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <variant>

#include "core/text/ipv4_network.hpp"
#include "io/loop.hpp"
#include "io/tcp/tcp_stream.hpp"

namespace rubicon::io {

/// Accepts connections from open() on until it is destroyed. When the process runs out of
/// descriptors it waits a while and goes on.
class tcp_listener {
public:
  /// Gets each new connection, not yet started, and who has made it. May destroy the listener.
  using callback = std::function<void(tcp_stream, const ipv4_address& from)>;

  /// Binds the first free port from `first_port` on; 0 lets the system choose.
  ///
  /// Deviation: SO_REUSEADDR is set, so that a peer that starts again gets its old port, under
  /// which others look for it (peis-wire.md 23, hazard 11); a port that somebody listens on stays
  /// refused.
  /// @param address an IPv4 address of this machine, 0.0.0.0 for all
  /// @returns the listener, or why there is none: `cannot listen on 10.0.0.1:8000: ...`
  [[nodiscard]] static std::variant<tcp_listener, std::string>
  open(loop& where, const std::string& address, std::uint16_t first_port, callback on_connection);

  ~tcp_listener();
  tcp_listener(tcp_listener&&) noexcept;
  tcp_listener& operator=(tcp_listener&&) noexcept;

  [[nodiscard]] std::uint16_t port() const;

  /// Accepts nobody for so long; who connects meanwhile waits in the system's queue.
  void rest(duration length);

private:
  struct state;
  explicit tcp_listener(std::shared_ptr<state> x);

  std::shared_ptr<state> state_;
};

/// Why nobody could listen at that very port now; empty: one could.
[[nodiscard]] std::string why_taken(loop& where, const std::string& address, std::uint16_t port);

} // namespace rubicon::io
