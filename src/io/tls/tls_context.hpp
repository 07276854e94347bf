// For files of this room only: what OpenSSL makes of a tls_identity.
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include <openssl/ssl.h>

#include "io/tls/certificate_files.hpp"
#include "io/tls/tls_identity.hpp"

namespace rubicon::io {

struct tls_free {
  void operator()(SSL_CTX* x) const { SSL_CTX_free(x); }
  void operator()(SSL* x) const { SSL_free(x); }
};

/// What is read of the files.
struct tls_parts {
  owned<X509> certificate;
  owned<EVP_PKEY> key;
  owned<X509> authority;
};

struct tls_identity::content {
  std::shared_ptr<const tls_parts> parts;
  std::unique_ptr<SSL_CTX, tls_free> context;
  std::string name;
  std::chrono::sys_seconds from;
  std::chrono::sys_seconds until;
  certificate_use use = certificate_use::any;
};

} // namespace rubicon::io
