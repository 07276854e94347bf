// By what the ends of the control plane know each other.
#pragma once

#include <string>

namespace rubicon::control {

/// PEM files, as `rubicon certs` makes them. Both ends of a connection show a certificate, and each
/// takes only those of its own authority.
struct tls_files {
  std::string certificate; ///< path; empty: there is no TLS
  std::string key;
  std::string authority;

  [[nodiscard]] bool empty() const { return certificate.empty(); }
};

} // namespace rubicon::control
