// Two ends of TLS, and what each says of the other.
#pragma once

#include <string>

#include "io/tls/tls_session.hpp"
#include "support/catch.hpp"
#include "support/text.hpp"

namespace rubicon::test {

/// Carries octets to and fro until nobody has any.
inline void talk(io::tls_session& a, io::tls_session& b) {
  for (;;) {
    const auto from_a = a.outgoing();
    const auto from_b = b.outgoing();
    if (from_a.empty() && from_b.empty())
      return;
    static_cast<void>(b.take(from_a));
    static_cast<void>(a.take(from_b));
  }
}

struct tls_outcome {
  std::string server; ///< why it has closed; empty: it has not
  std::string client;
};

inline tls_outcome meet(const io::tls_identity& host, const io::tls_identity& coordinator,
                        const std::string& name = {}) {
  using phase = io::tls_session::phase;
  io::tls_session server(host, io::tls_session::side::server);
  io::tls_session client(coordinator, io::tls_session::side::client, name);
  talk(client, server);
  return {server.now() == phase::closed ? server.why() : "",
          client.now() == phase::closed ? client.why() : ""};
}

/// Shows the text when a check fails.
inline bool has(const std::string& text, const std::string& part) {
  INFO(text);
  return contains(text, part);
}

} // namespace rubicon::test
