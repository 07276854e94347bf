#include "io/tls/tls_session.hpp"

#include <array>
#include <cassert>
#include <utility>

#include <openssl/err.h>
#include <openssl/x509_vfy.h>

#include "io/tls/certificates.hpp"
#include "io/tls/revocation_content.hpp"
#include "io/tls/tls_context.hpp"

namespace rubicon::io {

namespace {

constexpr std::size_t record_octets = 16 * 1024;

std::string in_quotes(const std::string& x) {
  return x.empty() ? x : " `" + x + '`';
}

/// @param name in quotes
std::string words_of_revoked(const std::string& name) {
  return "has a certificate" + name + " that was revoked";
}

std::string clock_here() {
  return "the clock here shows " + time_text(system_time());
}

std::string date_of(const ASN1_TIME& x) {
  const auto time = time_of(x);
  return time ? time_text(*time) : "an unknown date";
}

} // namespace

struct tls_session::state {
  state(const tls_identity& x, side which, const std::string& name)
      : own(x), is_server(which == side::server), wanted_name(name) {}

  const tls_identity own;
  const bool is_server;
  const std::string wanted_name;
  std::unique_ptr<SSL, tls_free> ssl;
  phase now = phase::shaking;
  std::size_t handshake_octets = 0;
  std::string peer_name;
  owned<X509> shown;        ///< by the other side, once it is believed
  std::string cert_problem; ///< why the other side's certificate is not valid
  std::string why;

  bool begin() {
    ssl.reset(SSL_new(own.inside()->context.get()));
    if (!ssl)
      return false;
    auto* const in = BIO_new(BIO_s_mem());
    auto* const out = BIO_new(BIO_s_mem());
    SSL_set_bio(ssl.get(), in, out); // takes both
    SSL_set_app_data(ssl.get(), this);
    SSL_set_verify(ssl.get(), SSL_VERIFY_PEER | SSL_VERIFY_FAIL_IF_NO_PEER_CERT, on_verify);
    SSL_set_hostflags(ssl.get(),
                      X509_CHECK_FLAG_NEVER_CHECK_SUBJECT | X509_CHECK_FLAG_NO_WILDCARDS);
    if (is_server)
      SSL_set_accept_state(ssl.get());
    else
      SSL_set_connect_state(ssl.get());
    return in != nullptr && out != nullptr &&
           (wanted_name.empty() || SSL_set1_host(ssl.get(), wanted_name.c_str()) == 1);
  }

  static int on_verify(int is_good, X509_STORE_CTX* about) {
    auto* const connection =
        static_cast<SSL*>(X509_STORE_CTX_get_ex_data(about, SSL_get_ex_data_X509_STORE_CTX_idx()));
    if (is_good == 0 && is_old_list(X509_STORE_CTX_get_error(about))) {
      X509_STORE_CTX_set_error(about, X509_V_OK);
      return 1;
    }
    if (is_good == 0)
      static_cast<state*>(SSL_get_app_data(connection))->note_problem(*about);
    return is_good;
  }

  /// A list of revoked certificates holds on until there is a newer one.
  static bool is_old_list(int error) {
    return error == X509_V_ERR_CRL_HAS_EXPIRED || error == X509_V_ERR_CRL_NOT_YET_VALID;
  }

  void note_problem(X509_STORE_CTX& about) {
    const auto* const x = X509_STORE_CTX_get_current_cert(&about);
    const auto* const leaf = X509_STORE_CTX_get0_cert(&about);
    const auto name = leaf == nullptr ? std::string() : in_quotes(common_name_of(*leaf));
    switch (X509_STORE_CTX_get_error(&about)) {
    case X509_V_ERR_CERT_HAS_EXPIRED:
      cert_problem = "has a certificate" + name + " that expired on " +
                     date_of(*X509_get0_notAfter(x)) + ", and " + clock_here();
      break;
    case X509_V_ERR_CERT_NOT_YET_VALID:
      cert_problem = "has a certificate" + name + " that is valid from " +
                     date_of(*X509_get0_notBefore(x)) + ", but " + clock_here() +
                     ": one of the two clocks is wrong";
      break;
    case X509_V_ERR_HOSTNAME_MISMATCH:
      cert_problem = "presented the certificate of" + name + ", not of `" + wanted_name + '`';
      break;
    case X509_V_ERR_INVALID_PURPOSE:
      cert_problem =
          "has a certificate" + name +
          (is_server ? " that is not a coordinator's: it may not deploy" : " that is not a host's");
      break;
    case X509_V_ERR_CERT_REVOKED:
      cert_problem = words_of_revoked(name);
      break;
    default: // it ends at an authority that is not ours
      cert_problem = "has a certificate" + name + " of another authority";
      if (!is_server)
        cert_problem += ", and rejected our certificate";
    }
  }

  [[nodiscard]] std::string why_not_taken(int alert) const {
    const std::string begin = "rejected our certificate";
    const auto now_here = system_time();
    switch (alert) {
    case SSL_AD_CERTIFICATE_EXPIRED:
      return begin + " `" + own.name() + "`: it expired on " + time_text(own.valid_until()) +
             (now_here < own.valid_until() ? ", and " + clock_here() + ": the clock there is wrong"
                                           : "");
    case SSL_AD_BAD_CERTIFICATE:
      return is_server
                 ? "rejected our certificate `" + own.name() + "`: it expects another host"
                 : begin + " `" + own.name() + "`: it is not yet valid there; it is valid from " +
                       time_text(own.valid_from()) + ", and " + clock_here() +
                       (now_here < own.valid_from() ? "" : ": the clock there is wrong");
    case SSL_AD_UNKNOWN_CA:
      return begin + " `" + own.name() + "`: it was signed by another authority";
    case SSL_AD_UNSUPPORTED_CERTIFICATE:
      return begin + " `" + own.name() + "`: it is not " +
             (is_server ? "a host's" : "a coordinator's");
    case SSL_AD_CERTIFICATE_REVOKED:
      return begin + " `" + own.name() + "`: it was revoked";
    case SSL_AD_PROTOCOL_VERSION:
      return "has no version of TLS in common with us";
    default:
      return "ended the handshake with alert " + std::to_string(alert);
    }
  }

  [[nodiscard]] std::string why_failed() const {
    if (!cert_problem.empty())
      return cert_problem;
    const auto error = ERR_peek_error();
    const auto reason = ERR_GET_REASON(error);
    if (ERR_GET_LIB(error) == ERR_LIB_SSL && reason >= SSL_AD_REASON_OFFSET)
      return why_not_taken(reason - SSL_AD_REASON_OFFSET);
    switch (reason) {
    case SSL_R_PEER_DID_NOT_RETURN_A_CERTIFICATE:
      return "presented no certificate";
    case SSL_R_WRONG_VERSION_NUMBER:
    case SSL_R_HTTP_REQUEST:
    case SSL_R_HTTPS_PROXY_REQUEST:
    case SSL_R_PACKET_LENGTH_TOO_LONG:
    case SSL_R_UNEXPECTED_MESSAGE:
      return is_server ? "does not speak TLS" : "does not speak TLS: it has no certificates";
    case SSL_R_UNSUPPORTED_PROTOCOL:
    case SSL_R_VERSION_TOO_LOW:
    case SSL_R_NO_SHARED_CIPHER:
      return "has no version of TLS in common with us";
    default:
      return "violated TLS (" + openssl_reason() + ')';
    }
  }

  void end(std::string text) {
    if (now == phase::closed)
      return;
    now = phase::closed;
    why = std::move(text);
  }

  /// What a call of OpenSSL's has come to, if it is no success.
  void judge(int returned) {
    switch (SSL_get_error(ssl.get(), returned)) {
    case SSL_ERROR_WANT_READ:
    case SSL_ERROR_WANT_WRITE:
      break;
    case SSL_ERROR_ZERO_RETURN:
      end("closed the connection");
      break;
    default:
      end(why_failed());
    }
    ERR_clear_error();
  }

  void shake() {
    ERR_clear_error();
    const auto done = SSL_do_handshake(ssl.get());
    if (done != 1)
      return judge(done);
    now = phase::open;
    shown.reset(SSL_get1_peer_certificate(ssl.get()));
    if (shown)
      peer_name = common_name_of(*shown);
    else
      end("presented no certificate"); // cannot be: OpenSSL is configured to refuse it
  }

  void read_all(bytes& to) {
    std::array<std::uint8_t, record_octets> block{};
    while (now == phase::open) {
      ERR_clear_error();
      const auto size = SSL_read(ssl.get(), block.data(), static_cast<int>(block.size()));
      if (size <= 0)
        return judge(size);
      to.insert(to.end(), block.begin(), block.begin() + size);
    }
  }
};

tls_session::tls_session(const tls_identity& own, side which, const std::string& name)
    : state_(std::make_unique<state>(own, which, name)) {
  if (!state_->begin())
    state_->end(openssl_reason());
  else if (which == side::client)
    state_->shake();
}

tls_session::~tls_session() = default;

tls_session::tls_session(tls_session&&) noexcept = default;

bytes tls_session::take(byte_view from_network) {
  auto& x = *state_;
  bytes said;
  if (x.now == phase::closed || from_network.empty())
    return said;
  if (BIO_write(SSL_get_rbio(x.ssl.get()), from_network.data(),
                static_cast<int>(from_network.size())) != static_cast<int>(from_network.size())) {
    x.end(openssl_reason());
    return said;
  }
  if (x.now == phase::shaking) {
    x.handshake_octets += from_network.size();
    x.shake();
    if (x.now == phase::shaking && x.handshake_octets > handshake_octets_max)
      x.end("sent too much before it authenticated");
  }
  x.read_all(said);
  return said;
}

void tls_session::send(byte_view octets) {
  auto& x = *state_;
  assert(x.now != phase::shaking);
  while (!octets.empty() && x.now == phase::open) {
    ERR_clear_error();
    const auto some = octets.first(std::min(octets.size(), record_octets));
    const auto size = SSL_write(x.ssl.get(), some.data(), static_cast<int>(some.size()));
    if (size <= 0)
      return x.end(x.why_failed()); // memory takes all there is
    octets = octets.subspan(static_cast<std::size_t>(size));
  }
}

void tls_session::close() {
  auto& x = *state_;
  if (x.now == phase::open) {
    ERR_clear_error();
    static_cast<void>(SSL_shutdown(x.ssl.get()));
    ERR_clear_error();
  }
  x.end("was closed on this side");
}

bytes tls_session::outgoing() {
  bytes out;
  if (!state_->ssl)
    return out;
  auto* const from = SSL_get_wbio(state_->ssl.get());
  const auto size = BIO_ctrl_pending(from);
  out.resize(size);
  if (size > 0 && BIO_read(from, out.data(), static_cast<int>(size)) != static_cast<int>(size))
    out.clear();
  return out;
}

tls_session::phase tls_session::now() const {
  return state_->now;
}

const std::string& tls_session::peer_name() const {
  return state_->peer_name;
}

std::string tls_session::why_revoked(const revocation_list& x) const {
  const auto& shown = state_->shown;
  return shown && revoked_at(x, *shown) ? words_of_revoked(in_quotes(state_->peer_name)) : "";
}

const std::string& tls_session::why() const {
  return state_->why;
}

} // namespace rubicon::io
