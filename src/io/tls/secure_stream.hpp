// A TCP connection between ends that know each other by their certificates, or a plain one.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "core/bytes.hpp"
#include "io/tcp/tcp_stream.hpp"
#include "io/tls/tls_identity.hpp"
#include "io/tls/tls_session.hpp"

namespace rubicon::io {

/// Callbacks run on the loop's thread, never from within a call, and may destroy the stream.
class secure_stream {
public:
  struct callbacks {
    /// The other side has shown who it is; the first call. A plain stream is ready from the start.
    std::function<void(const std::string& name)> on_ready;
    std::function<void(byte_view)> on_octets;
    /// All that was to be sent has been handed to the system.
    std::function<void()> on_sent;
    /// In words, a verb first: `shows no certificate`; once, nothing follows.
    std::function<void(const std::string& why)> on_closed;
  };

  /// Starts. @param own nothing: it is plain
  /// @param name that the other side must have; empty: any
  secure_stream(tcp_stream over, const std::optional<tls_identity>& own, tls_session::side which,
                const std::string& name, callbacks to_owner);
  ~secure_stream(); ///< closes TLS, and lets the alert with the cause leave
  secure_stream(secure_stream&&) noexcept;
  secure_stream& operator=(secure_stream&&) = delete;

  /// Whether more is to be received; what has arrived already still comes.
  void read(bool wanted);

  /// Queues octets; no more than a few hundred kilobytes of them are encrypted before they can
  /// leave. @pre it is ready
  void send(payload octets);

  /// As tls_session has it; empty for a plain one. @pre it is ready
  [[nodiscard]] std::string why_revoked(const revocation_list& x) const;

  /// Octets that have not been handed to the system.
  [[nodiscard]] std::size_t unsent() const;

private:
  struct state;
  std::shared_ptr<state> state_;
};

} // namespace rubicon::io
