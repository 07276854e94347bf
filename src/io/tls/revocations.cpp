#include "io/tls/revocations.hpp"

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <iterator>
#include <optional>
#include <system_error>

#include <openssl/err.h>
#include <openssl/pem.h>
#include <sys/stat.h>

#include "io/tls/revocation_content.hpp"
#include "io/tls/tls_identity.hpp"

namespace rubicon::io {

namespace {

using std::chrono::sys_seconds;

/// Nothing for a list without one, or with one that does not fit: ours count from 1.
std::optional<std::uint64_t> number_of(X509_CRL& x) {
  const owned<ASN1_INTEGER> found(
      static_cast<ASN1_INTEGER*>(X509_CRL_get_ext_d2i(&x, NID_crl_number, nullptr, nullptr)));
  std::uint64_t number = 0;
  if (!found || ASN1_INTEGER_get_uint64(&number, found.get()) != 1 || number == 0)
    return std::nullopt;
  return number;
}

bool is_signed_by(X509_CRL& x, X509& authority) {
  auto* const key = X509_get0_pubkey(&authority);
  return key != nullptr &&
         X509_NAME_cmp(X509_CRL_get_issuer(&x), X509_get_subject_name(&authority)) == 0 &&
         X509_CRL_verify(&x, key) == 1;
}

/// Why it holds now for nobody; empty: it holds.
std::string why_not_now(const sys_seconds& from, const sys_seconds& until, sys_seconds now,
                        bool may_be_over) {
  const auto clock = ", and the clock here says " + time_text(now);
  if (now < from)
    return "is valid from " + time_text(from) + " only" + clock;
  if (now >= until && !may_be_over)
    return "expired on " + time_text(until) + clock;
  return {};
}

} // namespace

std::string revocations_beside(const std::string& authority_path) {
  constexpr std::string_view ending = ".crt";
  return (authority_path.ends_with(ending)
              ? authority_path.substr(0, authority_path.size() - ending.size())
              : authority_path) +
         ".crl";
}

std::variant<revocation_list, std::string> revocation_list::read(std::string_view pem,
                                                                 const std::string& authority_path,
                                                                 sys_seconds now,
                                                                 bool may_be_over) {
  if (pem.size() > revocations_octets_max)
    return "is too long for a list of revoked certificates";
  auto authority = read_certificate(authority_path);
  if (auto* why = std::get_if<std::string>(&authority))
    return "cannot be checked: " + *why;
  auto made = std::make_shared<content>();
  const owned<BIO> in(BIO_new_mem_buf(pem.data(), static_cast<int>(pem.size())));
  ERR_clear_error();
  if (in)
    made->list.reset(PEM_read_bio_X509_CRL(in.get(), nullptr, nullptr, nullptr));
  if (!made->list)
    return "is not a list of revoked certificates in PEM (" + openssl_reason() + ')';
  auto& list = *made->list;
  if (!is_signed_by(list, *std::get<owned<X509>>(authority))) {
    ERR_clear_error();
    return "is not signed by " + authority_path;
  }
  const auto number = number_of(list);
  const auto* const next = X509_CRL_get0_nextUpdate(&list);
  const auto from = time_of(*X509_CRL_get0_lastUpdate(&list));
  const auto until = next == nullptr ? std::nullopt : time_of(*next);
  if (!number || !from || !until)
    return "is a list of revoked certificates without number or dates";
  if (auto why = why_not_now(*from, *until, now, may_be_over); !why.empty())
    return why;
  made->text = pem;
  made->number = *number;
  made->until = *until;
  const auto* const all = X509_CRL_get_REVOKED(&list);
  made->size = static_cast<std::size_t>(std::max(0, sk_X509_REVOKED_num(all)));
  return revocation_list(std::move(made));
}

std::uint64_t revocation_list::number() const {
  return content_->number;
}

sys_seconds revocation_list::valid_until() const {
  return content_->until;
}

std::size_t revocation_list::size() const {
  return content_->size;
}

const std::string& revocation_list::text() const {
  return content_->text;
}

bool is_same(const revocation_list& a, const revocation_list& b) {
  return X509_CRL_match(a.inside()->list.get(), b.inside()->list.get()) == 0;
}

std::optional<sys_seconds> revoked_at(const revocation_list& x, const X509& certificate) {
  X509_REVOKED* found = nullptr;
  // OpenSSL sorts the list when it first looks; a copy keeps what is shared as it is.
  const owned<X509_CRL> list(X509_CRL_dup(x.inside()->list.get()));
  const owned<X509> copy(X509_dup(&certificate));
  if (!list || !copy || X509_CRL_get0_by_cert(list.get(), &found, copy.get()) != 1)
    return std::nullopt;
  const auto at = time_of(*X509_REVOKED_get0_revocationDate(found));
  return at.value_or(sys_seconds{});
}

std::variant<std::optional<revocation_list>, std::string>
read_revocations(const std::string& path, const std::string& authority_path, sys_seconds now,
                 bool may_be_over) {
  struct stat about {};
  if (::stat(path.c_str(), &about) != 0 && errno == ENOENT)
    return std::optional<revocation_list>();
  if (!S_ISREG(about.st_mode)) // to open something else might wait for somebody
    return path + ": not a file";
  std::ifstream in(path, std::ios::binary);
  if (!in)
    return path + ": " + std::generic_category().message(errno);
  std::string text(revocations_octets_max + 1, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(in.gcount()));
  auto read = revocation_list::read(text, authority_path, now, may_be_over);
  if (auto* why = std::get_if<std::string>(&read))
    return path + ": " + *why;
  return std::optional(std::get<revocation_list>(std::move(read)));
}

} // namespace rubicon::io
