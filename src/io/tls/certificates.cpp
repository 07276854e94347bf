#include "io/tls/certificates.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cerrno>
#include <optional>
#include <system_error>
#include <utility>

#include <arpa/inet.h>
#include <openssl/ec.h>
#include <openssl/err.h>
#include <sys/stat.h>

#include "core/text/name.hpp"
#include "io/tls/certificate_files.hpp"
#include "io/tls/revocation_content.hpp"

namespace rubicon::io {

namespace {

using std::chrono::days;
using std::chrono::sys_seconds;

constexpr int serial_bits = 128;
constexpr mode_t folder_mode = 0700;

/// From a day before now, as many days as asked for.
struct validity {
  sys_seconds from;
  sys_seconds until;
};

validity validity_of(unsigned length, sys_seconds now) {
  assert(length >= 1 && length <= certificate_days_max);
  return {now - clock_error_max, now + days(length)};
}

bool set_serial(X509& x) {
  const owned<BIGNUM> number(BN_new());
  return number && BN_rand(number.get(), serial_bits, BN_RAND_TOP_ONE, BN_RAND_BOTTOM_ANY) == 1 &&
         BN_to_ASN1_INTEGER(number.get(), X509_get_serialNumber(&x)) != nullptr;
}

bool set_validity(X509& x, const validity& valid) {
  return ASN1_TIME_set(X509_getm_notBefore(&x), valid.from.time_since_epoch().count()) != nullptr &&
         ASN1_TIME_set(X509_getm_notAfter(&x), valid.until.time_since_epoch().count()) != nullptr;
}

bool set_subject(X509& x, const std::string& name) {
  const auto* const octets = reinterpret_cast<const unsigned char*>(name.data());
  return X509_NAME_add_entry_by_NID(X509_get_subject_name(&x), NID_commonName, MBSTRING_UTF8,
                                    octets, static_cast<int>(name.size()), -1, 0) == 1;
}

/// @param issuer may be `x` itself
bool set_extension(X509& x, X509& issuer, int kind, const char* value) {
  X509V3_CTX context;
  X509V3_set_ctx(&context, &issuer, &x, nullptr, nullptr, 0);
  const owned<X509_EXTENSION> extension(X509V3_EXT_nconf_nid(nullptr, &context, kind, value));
  return extension && X509_add_ext(&x, extension.get(), -1) == 1;
}

struct extension {
  int kind;
  const char* value;
};

/// In this order: an authority's identifier of itself comes from its subject's.
constexpr std::array authority_extensions{
    extension{NID_basic_constraints, "critical,CA:TRUE,pathlen:0"},
    extension{NID_key_usage, "critical,keyCertSign,cRLSign"},
    extension{NID_subject_key_identifier, "hash"},
    extension{NID_authority_key_identifier, "keyid:always"},
};

const char* ends_of(certificate_use x) {
  switch (x) {
  case certificate_use::host:
    return "serverAuth";
  case certificate_use::coordinator:
    return "clientAuth";
  case certificate_use::any:
  case certificate_use::none:
    break;
  }
  return "serverAuth,clientAuth";
}

std::array<extension, 5> host_extensions(certificate_use use) {
  return {{
      {NID_basic_constraints, "critical,CA:FALSE"},
      {NID_key_usage, "critical,digitalSignature"},
      {NID_ext_key_usage, ends_of(use)},
      {NID_subject_key_identifier, "hash"},
      {NID_authority_key_identifier, "keyid:always"},
  }};
}

template <class Extensions>
bool set_extensions(X509& x, X509& issuer, const Extensions& all) {
  return std::all_of(all.begin(), all.end(), [&](const extension& each) {
    return set_extension(x, issuer, each.kind, each.value);
  });
}

/// 4 or 16 octets; nothing for what is no IP address.
std::optional<std::string> ip_octets(const std::string& x) {
  std::array<char, 16> octets{};
  if (::inet_pton(AF_INET, x.c_str(), octets.data()) == 1)
    return std::string(octets.data(), 4);
  if (::inet_pton(AF_INET6, x.c_str(), octets.data()) == 1)
    return std::string(octets.data(), 16);
  return std::nullopt;
}

bool is_dns_label(std::string_view x) {
  const auto is_inner = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
           c == '_';
  };
  return !x.empty() && x.size() <= 63 && x.front() != '-' && x.back() != '-' &&
         std::all_of(x.begin(), x.end(), is_inner);
}

/// RFC 1123 2.1: the last label distinguishes a name from an address, and so is not a number.
bool is_dns_name(std::string_view x) {
  if (x.empty() || x.size() > 253)
    return false;
  for (;;) {
    const auto dot = x.find('.');
    const auto label = x.substr(0, dot);
    if (!is_dns_label(label))
      return false;
    if (dot == std::string_view::npos)
      return label.find_first_not_of("0123456789") != std::string_view::npos;
    x.remove_prefix(dot + 1);
  }
}

/// @param address an IP address, else taken for a DNS name
bool add_name(GENERAL_NAMES& to, const std::string& address) {
  const auto ip = ip_octets(address);
  const auto& octets = ip ? *ip : address;
  owned<GENERAL_NAME> name(GENERAL_NAME_new());
  owned<ASN1_STRING> value(ASN1_STRING_type_new(ip ? V_ASN1_OCTET_STRING : V_ASN1_IA5STRING));
  if (!name || !value ||
      ASN1_STRING_set(value.get(), octets.data(), static_cast<int>(octets.size())) != 1)
    return false;
  GENERAL_NAME_set0_value(name.get(), ip ? GEN_IPADD : GEN_DNS, value.release());
  if (sk_GENERAL_NAME_push(&to, name.get()) == 0)
    return false;
  static_cast<void>(name.release()); // the list's now
  return true;
}

bool set_names(X509& x, const new_certificate& wanted) {
  std::vector<std::string> all{wanted.host};
  for (const auto& address : wanted.addresses) {
    if (std::find(all.begin(), all.end(), address) == all.end())
      all.push_back(address);
  }
  const owned<GENERAL_NAMES> names(sk_GENERAL_NAME_new_null());
  return names &&
         std::all_of(all.begin(), all.end(),
                     [&](const auto& address) { return add_name(*names, address); }) &&
         X509_add1_ext_i2d(&x, NID_subject_alt_name, names.get(), 0, X509V3_ADD_DEFAULT) == 1;
}

bool sign(X509& x, EVP_PKEY& key) {
  return X509_sign(&x, &key, EVP_sha256()) > 0;
}

/// A certificate that lacks issuer, extensions and signature. @returns nothing if OpenSSL fails
owned<X509> draft(const std::string& name, const validity& valid, EVP_PKEY& key) {
  ERR_clear_error();
  owned<X509> x(X509_new());
  if (x && X509_set_version(x.get(), X509_VERSION_3) == 1 && set_serial(*x) &&
      set_validity(*x, valid) && set_subject(*x, name) && X509_set_pubkey(x.get(), &key) == 1)
    return x;
  return {};
}

/// The same with a key of its own. @returns nulls if OpenSSL fails
certificate_pair draft(const std::string& name, const validity& valid) {
  owned<EVP_PKEY> key(EVP_EC_gen("P-256"));
  auto x = key ? draft(name, valid, *key) : nullptr;
  return x ? certificate_pair{std::move(x), std::move(key)} : certificate_pair{};
}

/// @returns nulls if OpenSSL fails
certificate_pair build_authority(const new_authority& wanted, const validity& valid) {
  auto x = draft(wanted.name, valid);
  if (x.certificate &&
      X509_set_issuer_name(x.certificate.get(), X509_get_subject_name(x.certificate.get())) == 1 &&
      set_extensions(*x.certificate, *x.certificate, authority_extensions) &&
      sign(*x.certificate, *x.key))
    return x;
  return {};
}

/// @returns nulls if OpenSSL fails
certificate_pair build_certificate(const new_certificate& wanted, const validity& valid,
                                   const certificate_pair& authority) {
  auto x = draft(wanted.host, valid);
  auto& issuer = *authority.certificate;
  if (x.certificate &&
      X509_set_issuer_name(x.certificate.get(), X509_get_subject_name(&issuer)) == 1 &&
      set_names(*x.certificate, wanted) &&
      set_extensions(*x.certificate, issuer, host_extensions(wanted.use)) &&
      sign(*x.certificate, *authority.key))
    return x;
  return {};
}

/// Another one for the same name and addresses. @returns nulls if OpenSSL fails
/// @param key nothing: the one that it has
certificate_pair build_renewal(const X509& former, certificate_use use, const validity& valid,
                               owned<EVP_PKEY> key, const certificate_pair& authority) {
  auto& issuer = *authority.certificate;
  auto* const former_key = X509_get0_pubkey(&former);
  certificate_pair x{draft(common_name_of(former), valid, key ? *key : *former_key),
                     std::move(key)};
  const auto names = X509_get_ext_by_NID(&former, NID_subject_alt_name, -1);
  if (x.certificate && names >= 0 &&
      X509_set_issuer_name(x.certificate.get(), X509_get_subject_name(&issuer)) == 1 &&
      X509_add_ext(x.certificate.get(), X509_get_ext(&former, names), -1) == 1 &&
      set_extensions(*x.certificate, issuer, host_extensions(use)) &&
      sign(*x.certificate, *authority.key))
    return x;
  return {};
}

/// Why a certificate cannot be renewed so; empty: it can.
std::string refusal(const renewal& x, const std::string& path, const X509& former,
                    const certificate_pair& authority,
                    const std::optional<revocation_list>& revoked) {
  if (X509_verify(const_cast<X509*>(&former), authority.key.get()) != 1 ||
      X509_get0_pubkey(&former) == nullptr)
    return path + ": signed by another authority, so it cannot be renewed here";
  if (common_name_of(former) != x.host)
    return path + ": the certificate of `" + common_name_of(former) + '`';
  if (revoked && revoked_at(*revoked, former) && !x.new_key)
    return path + ": it was revoked, so its key may be compromised: use --new-key";
  const auto use = use_of(former);
  if (use == certificate_use::any && x.use == certificate_use::any)
    return path +
           ": it is valid both for a host and for a coordinator: choose --host or --coordinator";
  if (use != certificate_use::any && x.use != certificate_use::any && x.use != use)
    return path + ": its use is " + std::string(to_string(use)) +
           ", which cannot change; `rubicon certs add` makes one for another use under another "
           "name";
  return {};
}

/// Why this is no certificate to make; empty: it is one.
std::string refusal(const new_certificate& x) {
  if (!is_name(x.host))
    return '`' + x.host + "`: the name of a host is 1 to 32 letters, digits, - and _";
  if (x.host == authority_name)
    return '`' + x.host + "`: the files of the authority have this name";
  if (x.addresses.size() > certificate_addresses_max)
    return "more than " + std::to_string(certificate_addresses_max) + " addresses";
  for (const auto& address : x.addresses) {
    // A text with a null octet in it would be another one to what reads it up to there.
    if (!is_dns_name(address) && (address.find('\0') != std::string::npos || !ip_octets(address)))
      return '`' + address + "`: neither an IP address nor a DNS name";
  }
  return {};
}

std::variant<made_certificate, std::string> write_pair(const certificate_pair& x,
                                                       const std::string& folder,
                                                       std::string_view name, sys_seconds until) {
  const made_certificate made{path_in(folder, name, ".crt"), path_in(folder, name, ".key"), until};
  if (!x.certificate)
    return made.file + ": " + openssl_reason();
  if (auto why_not = create_files(x, made.file, made.key_file))
    return *std::move(why_not);
  return made;
}

} // namespace

std::variant<certificate_pair, std::string> read_authority(const std::string& folder,
                                                           sys_seconds now) {
  const auto path = path_in(folder, authority_name, ".crt");
  const auto key_path = path_in(folder, authority_name, ".key");
  auto certificate = read_certificate(path);
  if (auto* why = std::get_if<std::string>(&certificate))
    return std::move(*why);
  auto key = read_key(key_path);
  if (auto* why = std::get_if<std::string>(&key))
    return std::move(*why);
  certificate_pair x{std::move(std::get<owned<X509>>(certificate)),
                     std::move(std::get<owned<EVP_PKEY>>(key))};
  if (X509_check_ca(x.certificate.get()) != 1)
    return path + ": the certificate of a host, not of an authority";
  if (X509_check_private_key(x.certificate.get(), x.key.get()) != 1)
    return key_path + ": not the key of " + path;
  const auto until = end_of(*x.certificate);
  if (!until || *until <= now)
    return path + ": the authority has expired; create another one in a new folder";
  return x;
}

sys_seconds system_time() {
  return std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
}

std::variant<made_certificate, std::string>
make_authority(const std::string& folder, const new_authority& x, sys_seconds now) {
  if (!is_name(x.name))
    return '`' + x.name + "`: the name of an authority is 1 to 32 letters, digits, - and _";
  if (::mkdir(folder.c_str(), folder_mode) != 0 && errno != EEXIST)
    return folder + ": " + std::generic_category().message(errno);
  const auto valid = validity_of(x.days, now);
  return write_pair(build_authority(x, valid), folder, authority_name, valid.until);
}

std::variant<made_certificate, std::string>
make_certificate(const std::string& folder, const new_certificate& x, sys_seconds now) {
  if (auto why_not = refusal(x); !why_not.empty())
    return why_not;
  const auto authority = read_authority(folder, now);
  if (const auto* why = std::get_if<std::string>(&authority))
    return *why;
  const auto& signer = std::get<certificate_pair>(authority);
  auto valid = validity_of(x.days, now);
  valid.until = std::min(valid.until, *end_of(*signer.certificate)); // nobody believes it longer
  return write_pair(build_certificate(x, valid, signer), folder, x.host, valid.until);
}

std::variant<made_certificate, std::string> renew_certificate(const std::string& folder,
                                                              const renewal& x, sys_seconds now) {
  if (auto why_not = refusal(new_certificate{.host = x.host}); !why_not.empty())
    return why_not;
  const auto authority = read_authority(folder, now);
  if (const auto* why = std::get_if<std::string>(&authority))
    return *why;
  const auto& signer = std::get<certificate_pair>(authority);
  const auto lock = lock_of(folder);
  if (const auto* why = std::get_if<std::string>(&lock))
    return *why;
  made_certificate made{path_in(folder, x.host, ".crt"),
                        x.new_key ? path_in(folder, x.host, ".key") : std::string(),
                        {}};
  const auto former = read_certificate(made.file);
  if (const auto* why = std::get_if<std::string>(&former))
    return *why;
  const auto& old = *std::get<owned<X509>>(former);
  const auto ca = path_in(folder, authority_name, ".crt");
  const auto revoked = read_revocations(revocations_beside(ca), ca, now);
  if (const auto* why = std::get_if<std::string>(&revoked))
    return *why;
  if (auto why_not = refusal(x, made.file, old, signer, std::get<0>(revoked)); !why_not.empty())
    return why_not;
  auto valid = validity_of(x.days, now);
  valid.until = std::min(valid.until, *end_of(*signer.certificate));
  made.valid_until = valid.until;
  const auto use = use_of(old) == certificate_use::any ? x.use : use_of(old);
  const auto renewed = build_renewal(
      old, use, valid, owned<EVP_PKEY>(x.new_key ? EVP_EC_gen("P-256") : nullptr), signer);
  if (!renewed.certificate || (x.new_key && !renewed.key))
    return made.file + ": " + openssl_reason();
  if (auto why_not = replace_files(renewed, old, folder, x.host))
    return *std::move(why_not);
  return made;
}

} // namespace rubicon::io
