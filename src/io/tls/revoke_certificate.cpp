// What takes certificates back.
#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

#include <openssl/err.h>
#include <openssl/pem.h>

#include "core/text/name.hpp"
#include "io/tls/certificate_files.hpp"
#include "io/tls/revocation_content.hpp"

namespace rubicon::io {

namespace {

using std::chrono::sys_seconds;

/// HOST.crt and what it has taken the place of.
std::vector<std::string> certificates_of(const std::string& folder, const std::string& host) {
  std::vector<std::string> all{path_in(folder, host, ".crt")};
  std::error_code ignored;
  for (const auto& each : std::filesystem::directory_iterator(former_in(folder), ignored)) {
    const auto name = each.path().filename().string();
    const bool is_one = name.ends_with(".crt") && name.size() > host.size() &&
                        name.starts_with(host + '-') &&
                        name.find('-', host.size() + 1) == std::string::npos;
    if (is_one)
      all.push_back(each.path().string());
  }
  std::sort(all.begin() + 1, all.end());
  return all;
}

owned<ASN1_STRING> time_from(sys_seconds x) {
  return owned<ASN1_STRING>(ASN1_TIME_set(nullptr, x.time_since_epoch().count()));
}

bool add(X509_CRL& to, const X509& x, const ASN1_TIME& now) {
  owned<X509_REVOKED> entry(X509_REVOKED_new());
  const owned<ASN1_STRING> serial(ASN1_INTEGER_dup(X509_get0_serialNumber(&x)));
  const bool is_good =
      entry && serial && X509_REVOKED_set_serialNumber(entry.get(), serial.get()) == 1 &&
      X509_REVOKED_set_revocationDate(entry.get(), const_cast<ASN1_TIME*>(&now)) == 1 &&
      X509_CRL_add0_revoked(&to, entry.get()) == 1;
  if (is_good)
    static_cast<void>(entry.release()); // the list's now
  return is_good;
}

bool add_all(X509_CRL& to, const std::optional<revocation_list>& before) {
  auto* const all = before ? X509_CRL_get_REVOKED(before->inside()->list.get()) : nullptr;
  for (int i = 0; i < sk_X509_REVOKED_num(all); ++i) {
    owned<X509_REVOKED> copy(X509_REVOKED_dup(sk_X509_REVOKED_value(all, i)));
    if (!copy || X509_CRL_add0_revoked(&to, copy.get()) != 1)
      return false;
    static_cast<void>(copy.release());
  }
  return true;
}

bool set_number(X509_CRL& x, X509& authority, std::uint64_t number) {
  const owned<ASN1_INTEGER> value(ASN1_INTEGER_new());
  X509V3_CTX context;
  X509V3_set_ctx(&context, &authority, nullptr, nullptr, &x, 0);
  const owned<X509_EXTENSION> issuer(
      X509V3_EXT_nconf_nid(nullptr, &context, NID_authority_key_identifier, "keyid:always"));
  return value && issuer && ASN1_INTEGER_set_uint64(value.get(), number) == 1 &&
         X509_CRL_add1_ext_i2d(&x, NID_crl_number, value.get(), 0, X509V3_ADD_DEFAULT) == 1 &&
         X509_CRL_add_ext(&x, issuer.get(), -1) == 1;
}

/// @returns nothing if OpenSSL fails
owned<BIO> build_list(const certificate_pair& authority,
                      const std::optional<revocation_list>& before,
                      const std::vector<owned<X509>>& more, std::uint64_t number, sys_seconds now) {
  ERR_clear_error();
  auto& issuer = *authority.certificate;
  const owned<X509_CRL> x(X509_CRL_new());
  const auto today = time_from(now);
  const auto from = time_from(now - clock_error_max);
  auto out = memory();
  if (!x || !today || !from || !out || X509_CRL_set_version(x.get(), X509_CRL_VERSION_2) != 1 ||
      X509_CRL_set_issuer_name(x.get(), X509_get_subject_name(&issuer)) != 1 ||
      X509_CRL_set1_lastUpdate(x.get(), from.get()) != 1 ||
      X509_CRL_set1_nextUpdate(x.get(), X509_get0_notAfter(&issuer)) != 1 || !add_all(*x, before))
    return nullptr;
  for (const auto& each : more)
    if (!add(*x, *each, *today))
      return nullptr;
  if (!set_number(*x, issuer, number) || X509_CRL_sort(x.get()) != 1 ||
      X509_CRL_sign(x.get(), authority.key.get(), EVP_sha256()) <= 0 ||
      PEM_write_bio_X509_CRL(out.get(), x.get()) != 1)
    return nullptr;
  return out;
}

/// Those of the files that are the authority's and not listed; or why one cannot be judged.
std::variant<std::vector<owned<X509>>, std::string>
not_listed(const std::vector<std::string>& paths, const certificate_pair& authority,
           const std::optional<revocation_list>& before) {
  std::vector<owned<X509>> out;
  for (const auto& path : paths) {
    auto found = read_certificate(path);
    if (auto* why = std::get_if<std::string>(&found))
      return std::move(*why);
    auto& x = std::get<owned<X509>>(found);
    if (X509_verify(x.get(), authority.key.get()) != 1)
      return path + ": signed by another authority: revoke it in that authority's folder";
    if (!before || !revoked_at(*before, *x))
      out.push_back(std::move(x));
  }
  return out;
}

} // namespace

std::variant<made_revocation, std::string>
revoke_certificate(const std::string& folder, const std::string& host, sys_seconds now) {
  if (host == authority_name)
    return "an authority cannot be revoked: create another one in a new folder, and new "
           "certificates for all hosts";
  if (!is_name(host))
    return '`' + host + "`: the name of a host is 1 to 32 letters, digits, - and _";
  const auto authority = read_authority(folder, now);
  if (const auto* why = std::get_if<std::string>(&authority))
    return *why;
  const auto& signer = std::get<certificate_pair>(authority);
  const auto lock = lock_of(folder);
  if (const auto* why = std::get_if<std::string>(&lock))
    return *why;
  const auto ca = path_in(folder, authority_name, ".crt");
  made_revocation made{revocations_beside(ca), 1, 0};
  const auto read = read_revocations(made.file, ca, now);
  if (const auto* why = std::get_if<std::string>(&read))
    return *why;
  const auto& before = std::get<0>(read);
  const auto more = not_listed(certificates_of(folder, host), signer, before);
  if (const auto* why = std::get_if<std::string>(&more))
    return *why;
  const auto& added = std::get<0>(more);
  if (added.empty())
    return host + " is already revoked, in " + made.file;
  made.number = before ? before->number() + 1 : 1;
  made.added = added.size();
  const auto octets = build_list(signer, before, added, made.number, now);
  if (!octets)
    return made.file + ": " + openssl_reason();
  if (auto why_not = replace_with(made.file, *octets))
    return *std::move(why_not);
  return made;
}

} // namespace rubicon::io
