// For files of this room only: what OpenSSL makes of a tls_identity.
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include <openssl/ssl.h>

#include "io/certificate_files.hpp"
#include "io/tls_identity.hpp"

namespace rubicon::io {

struct tls_free {
  void operator()(SSL_CTX* x) const { SSL_CTX_free(x); }
  void operator()(SSL* x) const { SSL_free(x); }
};

struct tls_identity::content {
  std::unique_ptr<SSL_CTX, tls_free> context;
  std::string name;
  std::chrono::sys_seconds from;
  std::chrono::sys_seconds until;
};

} // namespace rubicon::io
