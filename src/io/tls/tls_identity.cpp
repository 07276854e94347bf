#include "io/tls/tls_identity.hpp"

#include <array>
#include <cstdio>
#include <string_view>
#include <utility>

#include <openssl/err.h>
#include <openssl/x509_vfy.h>
#include <sys/stat.h>

#include "io/tls/revocation_content.hpp"
#include "io/tls/tls_context.hpp"

namespace rubicon::io {

namespace {

using std::chrono::sys_seconds;

constexpr long chain_octets_max = 32 * 1024; ///< of certificates that somebody shows
constexpr const char* ciphers_of_tls_1_2 = "ECDHE+AESGCM:ECDHE+CHACHA20";

std::string why_exposed(const std::string& path) {
  struct stat about {};
  if (::stat(path.c_str(), &about) != 0 || (about.st_mode & (S_IRWXG | S_IRWXO)) == 0)
    return {};
  std::array<char, 8> mode{};
  static_cast<void>(std::snprintf(mode.data(), mode.size(), "%04o",
                                  static_cast<unsigned>(about.st_mode & 07777U)));
  return path + ": other users may read or change this key (mode " + mode.data() +
         "): run chmod 600, and make a new certificate if it may have been read";
}

std::string why_not_now(const std::string& path, const X509& x, sys_seconds now) {
  const auto from = time_of(*X509_get0_notBefore(&x));
  const auto until = end_of(x);
  if (!from || !until)
    return path + ": no valid times";
  const auto clock = ", and the clock of this computer shows " + time_text(now);
  if (now < *from)
    return path + ": valid from " + time_text(*from) + " only" + clock;
  if (now >= *until)
    return path + ": expired on " + time_text(*until) + clock +
           "; `rubicon certs renew` makes a new one";
  return {};
}

std::string why_not_signed(const tls_files& files, X509& certificate, X509& authority) {
  const owned<X509_STORE> trusted(X509_STORE_new());
  const owned<X509_STORE_CTX> question(X509_STORE_CTX_new());
  if (!trusted || !question || X509_STORE_add_cert(trusted.get(), &authority) != 1 ||
      X509_STORE_CTX_init(question.get(), trusted.get(), &certificate, nullptr) != 1)
    return openssl_reason();
  // Dates are judged by the time that the caller says.
  X509_VERIFY_PARAM_set_flags(X509_STORE_CTX_get0_param(question.get()), X509_V_FLAG_NO_CHECK_TIME);
  if (X509_verify_cert(question.get()) == 1)
    return {};
  return files.certificate + ": not signed by " + files.authority + " (" +
         X509_verify_cert_error_string(X509_STORE_CTX_get_error(question.get())) + ')';
}

/// Why it is unfit; empty: it is good.
std::string read(tls_parts& to, const tls_files& files, sys_seconds now, const std::string& name) {
  auto certificate = read_certificate(files.certificate);
  if (auto* why = std::get_if<std::string>(&certificate))
    return std::move(*why);
  auto authority = read_certificate(files.authority);
  if (auto* why = std::get_if<std::string>(&authority))
    return std::move(*why);
  auto key = read_key(files.key);
  if (auto* why = std::get_if<std::string>(&key))
    return std::move(*why);
  to = {std::get<owned<X509>>(std::move(certificate)), std::get<owned<EVP_PKEY>>(std::move(key)),
        std::get<owned<X509>>(std::move(authority))};
  if (auto why = why_exposed(files.key); !why.empty())
    return why;
  if (X509_check_private_key(to.certificate.get(), to.key.get()) != 1)
    return files.key + ": not the key of " + files.certificate;
  if (X509_check_ca(to.authority.get()) != 1)
    return files.authority + ": not the certificate of an authority";
  if (auto why = why_not_now(files.authority, *to.authority, now); !why.empty())
    return why;
  if (auto why = why_not_now(files.certificate, *to.certificate, now); !why.empty())
    return why;
  if (auto why = why_not_signed(files, *to.certificate, *to.authority); !why.empty())
    return why;
  const auto use = use_of(*to.certificate);
  if (!name.empty() && use != certificate_use::any && use != certificate_use::host)
    return files.certificate + ": not the certificate of a host (`certs list` says `" +
           std::string(to_string(use)) + "`)";
  if (!name.empty() && X509_check_host(to.certificate.get(), name.data(), name.size(),
                                       X509_CHECK_FLAG_NEVER_CHECK_SUBJECT, nullptr) != 1)
    return files.certificate + ": the certificate of `" + common_name_of(*to.certificate) +
           "`, not of `" + name + '`';
  return {};
}

/// Nothing is resumed: whoever comes again shows its certificate again.
bool configure(SSL_CTX& x, const tls_parts& of) {
  SSL_CTX_set_options(&x,
                      SSL_OP_NO_TICKET | SSL_OP_NO_RENEGOTIATION | SSL_OP_CIPHER_SERVER_PREFERENCE);
  SSL_CTX_set_session_cache_mode(&x, SSL_SESS_CACHE_OFF);
  SSL_CTX_set_max_cert_list(&x, chain_octets_max);
  SSL_CTX_set_mode(&x, SSL_MODE_RELEASE_BUFFERS | SSL_MODE_ENABLE_PARTIAL_WRITE |
                           SSL_MODE_NO_AUTO_CHAIN); // the other side has the authority's
  return SSL_CTX_set_min_proto_version(&x, TLS1_2_VERSION) == 1 &&
         SSL_CTX_set_cipher_list(&x, ciphers_of_tls_1_2) == 1 &&
         SSL_CTX_set_num_tickets(&x, 0) == 1 &&
         SSL_CTX_use_certificate(&x, of.certificate.get()) == 1 &&
         SSL_CTX_use_PrivateKey(&x, of.key.get()) == 1 &&
         X509_STORE_add_cert(SSL_CTX_get_cert_store(&x), of.authority.get()) == 1;
}

/// Certificates that the list names are refused.
bool apply_revocations(SSL_CTX& x, const revocation_list& revoked) {
  auto* const store = SSL_CTX_get_cert_store(&x);
  return X509_STORE_add_crl(store, revoked.inside()->list.get()) == 1 &&
         X509_STORE_set_flags(store, X509_V_FLAG_CRL_CHECK) == 1;
}

std::shared_ptr<tls_identity::content> content_of(std::shared_ptr<const tls_parts> of,
                                                  const revocation_list* revoked) {
  auto made = std::make_shared<tls_identity::content>();
  made->context.reset(SSL_CTX_new(TLS_method()));
  if (!made->context || !configure(*made->context, *of))
    return nullptr;
  if (revoked != nullptr && !apply_revocations(*made->context, *revoked))
    return nullptr;
  made->name = common_name_of(*of->certificate);
  made->from = *time_of(*X509_get0_notBefore(of->certificate.get()));
  made->until = *end_of(*of->certificate);
  made->use = use_of(*of->certificate);
  made->parts = std::move(of);
  return made;
}

} // namespace

std::variant<tls_identity, std::string> tls_identity::load(const tls_files& files, sys_seconds now,
                                                           const std::string& name) {
  ERR_clear_error();
  auto of = std::make_shared<tls_parts>();
  auto why_not = read(*of, files, now, name);
  ERR_clear_error();
  if (!why_not.empty())
    return why_not;
  auto made = content_of(std::move(of), nullptr);
  if (!made)
    return files.certificate + ": " + openssl_reason();
  return tls_identity(std::move(made));
}

std::variant<tls_identity, std::string> tls_identity::with(const revocation_list& revoked) const {
  ERR_clear_error();
  auto made = content_of(content_->parts, &revoked);
  if (!made)
    return openssl_reason();
  return tls_identity(std::move(made));
}

std::optional<sys_seconds> tls_identity::revoked_by(const revocation_list& x) const {
  return revoked_at(x, *content_->parts->certificate);
}

std::string tls_identity::authority_mark() const {
  constexpr std::size_t octets = 8;
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned size = 0;
  if (X509_pubkey_digest(content_->parts->authority.get(), EVP_sha256(), digest.data(), &size) != 1)
    return {};
  std::string text;
  for (std::size_t i = 0; i < octets; ++i) {
    constexpr std::string_view digits = "0123456789abcdef";
    text += digits[digest[i] >> 4U];
    text += digits[digest[i] & 15U];
  }
  return text;
}

certificate_use tls_identity::use() const {
  return content_->use;
}

const std::string& tls_identity::name() const {
  return content_->name;
}

sys_seconds tls_identity::valid_from() const {
  return content_->from;
}

sys_seconds tls_identity::valid_until() const {
  return content_->until;
}

std::string time_text(sys_seconds x) {
  const auto day = std::chrono::floor<std::chrono::days>(x);
  const std::chrono::year_month_day date(day);
  const std::chrono::hh_mm_ss time(x - day);
  std::array<char, 64> text{};
  static_cast<void>(std::snprintf(
      text.data(), text.size(), "%04d-%02u-%02u %02d:%02d UTC", static_cast<int>(date.year()),
      static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()),
      static_cast<int>(time.hours().count()), static_cast<int>(time.minutes().count())));
  return text.data();
}

} // namespace rubicon::io
