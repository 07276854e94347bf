#include "control/caf_system.hpp"

#include <cstddef>
#include <stdexcept>
#include <string>

#include <openssl/err.h>
#include <openssl/ssl.h>
#include <unistd.h>

namespace rubicon::control {

namespace {

// OpenSSL keeps errors for a thread until somebody asks. CAF's module does not: what went wrong
// with one connection would then be taken for a fault of the next one on the same thread, which is
// closed for it. So errors of others are forgotten with each record that a connection carries, and
// when one ends; and an end without a goodbye is no error.
void forget_errors(int, int, int, const void*, std::size_t, SSL*, void*) {
  ERR_clear_error();
}
void begin_connection(void* ssl, void*, CRYPTO_EX_DATA*, int, long, void*) {
  auto* const connection = static_cast<SSL*>(ssl);
  SSL_set_options(connection, SSL_OP_IGNORE_UNEXPECTED_EOF);
  SSL_set_msg_callback(connection, forget_errors);
}
void end_connection(void*, void*, CRYPTO_EX_DATA*, int, long, void*) {
  ERR_clear_error();
}

void watch_connections() {
  [[maybe_unused]] static const int index =
      SSL_get_ex_new_index(0, nullptr, begin_connection, nullptr, end_connection);
}

} // namespace

settings::settings(const tls_files& tls) {
  add_message_types<caf::id_block::rubicon_control>();
  load<caf::io::middleman>();
  set("scheduler.max-threads", 2U);
  set("scheduler.policy", caf::atom("sharing")); // waits for work; stealing looks for it all day
  set("logger.verbosity", caf::atom("quiet"));
  if (tls.empty())
    return;
  for (const auto& file : {tls.certificate, tls.key, tls.authority})
    if (::access(file.c_str(), R_OK) != 0)
      throw std::runtime_error(file + " cannot be read");
  openssl_certificate = tls.certificate;
  openssl_key = tls.key;
  openssl_cafile = tls.authority;
  load<caf::openssl::manager>();
  watch_connections();
}

system::system(const tls_files& tls) : impl_(std::make_unique<impl>(tls)) {}

system::~system() = default;

} // namespace rubicon::control
