// One TLS connection without a socket: octets of the network in, octets for the network out.
#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <string>

#include "core/bytes.hpp"
#include "io/tls/tls_identity.hpp"

namespace rubicon::io {

/// TLS 1.2 or later, with a certificate at both ends.
///
///   shaking --both believe each other--> open --end of either--> closed
///      |                                                           ^
///      +-- anything else: why() ------------------------------------+
class tls_session {
public:
  enum class phase : std::uint8_t { shaking, open, closed };
  enum class side : std::uint8_t { server, client };

  /// More from somebody who is not known yet is refused.
  static constexpr std::size_t handshake_octets_max = std::size_t{96} << 10;

  /// @param name that the other side's certificate must have; empty: any
  tls_session(const tls_identity& own, side which, const std::string& name = {});
  ~tls_session();
  tls_session(tls_session&&) noexcept;
  tls_session& operator=(tls_session&&) = delete;

  /// @returns what the other side says in these octets
  [[nodiscard]] bytes take(byte_view from_network);

  /// @pre open
  void send(byte_view octets);

  /// Says that no more will be sent.
  void close();

  /// What is to go to the network, also after a failure: an alert with its cause.
  [[nodiscard]] bytes outgoing();

  [[nodiscard]] phase now() const;

  /// Of the other side's certificate. @pre open, or closed after that
  [[nodiscard]] const std::string& peer_name() const;

  /// Why the list does not let the other side in any more; empty: it does. @pre as peer_name()
  [[nodiscard]] std::string why_revoked(const revocation_list& x) const;

  /// What ended it, as a verb and more: `shows no certificate`. @pre closed
  [[nodiscard]] const std::string& why() const;

private:
  struct state;
  std::unique_ptr<state> state_; ///< OpenSSL refers to it
};

} // namespace rubicon::io
