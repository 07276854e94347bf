#include <algorithm>
#include <array>
#include <cerrno>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>

#include <arpa/inet.h>
#include <openssl/err.h>
#include <openssl/x509_vfy.h>
#include <sys/stat.h>

#include "io/tls/certificate_files.hpp"
#include "io/tls/certificates.hpp"
#include "io/tls/revocation_content.hpp"

namespace rubicon::io {

namespace {

constexpr std::string_view ending = ".crt";

std::string text_of(const ASN1_STRING& x) {
  const auto* const octets = reinterpret_cast<const char*>(ASN1_STRING_get0_data(&x));
  return {octets, static_cast<std::size_t>(ASN1_STRING_length(&x))};
}

std::string ip_text(const std::string& octets) {
  std::array<char, INET6_ADDRSTRLEN> text{};
  const auto family = octets.size() == 4 ? AF_INET : AF_INET6;
  if ((octets.size() != 4 && octets.size() != 16) ||
      ::inet_ntop(family, octets.data(), text.data(), text.size()) == nullptr)
    return "?";
  return text.data();
}

std::vector<std::string> addresses_of(const X509& x) {
  const owned<GENERAL_NAMES> names(
      static_cast<GENERAL_NAMES*>(X509_get_ext_d2i(&x, NID_subject_alt_name, nullptr, nullptr)));
  std::vector<std::string> all;
  for (int i = 0; names && i < sk_GENERAL_NAME_num(names.get()); ++i) {
    const auto* const name = sk_GENERAL_NAME_value(names.get(), i);
    if (name->type == GEN_DNS)
      all.push_back(text_of(*name->d.dNSName));
    else if (name->type == GEN_IPADD)
      all.push_back(ip_text(text_of(*name->d.iPAddress)));
  }
  return all;
}

/// Whenever that was.
bool is_signed_by(X509& authority, X509& x) {
  const owned<X509_STORE> trusted(X509_STORE_new());
  const owned<X509_STORE_CTX> question(X509_STORE_CTX_new());
  if (!trusted || !question || X509_STORE_add_cert(trusted.get(), &authority) != 1 ||
      X509_STORE_CTX_init(question.get(), trusted.get(), &x, nullptr) != 1)
    return false;
  X509_VERIFY_PARAM_set_flags(X509_STORE_CTX_get0_param(question.get()), X509_V_FLAG_NO_CHECK_TIME);
  return X509_verify_cert(question.get()) == 1;
}

/// @param certificate nullptr if there is none to compare with
key_state state_of_key(const std::string& path, const X509* certificate) {
  struct stat about {};
  if (::stat(path.c_str(), &about) != 0)
    return errno == ENOENT ? key_state::missing : key_state::unreadable;
  if ((about.st_mode & (S_IRWXG | S_IRWXO)) != 0)
    return key_state::exposed;
  const auto key = read_key(path);
  if (std::holds_alternative<std::string>(key))
    return key_state::unreadable;
  if (certificate != nullptr &&
      X509_check_private_key(certificate, std::get<owned<EVP_PKEY>>(key).get()) != 1)
    return key_state::foreign;
  return key_state::safe;
}

/// What the certificate itself says. @returns false if it has times that no calendar has
bool describe(listed_certificate& to, const X509& x) {
  const auto from = time_of(*X509_get0_notBefore(&x));
  const auto until = end_of(x);
  if (!from || !until)
    return false;
  to.name = common_name_of(x);
  to.addresses = addresses_of(x);
  to.use = use_of(x);
  to.valid_from = *from;
  to.valid_until = *until;
  return true;
}

listed_certificate look_at(const std::string& folder, const std::string& stem, X509& authority,
                           const std::optional<revocation_list>& revoked) {
  const auto path = folder + '/' + stem;
  listed_certificate x;
  x.file = stem + std::string(ending);
  x.name = stem;
  const auto read = read_certificate(path + std::string(ending));
  const auto* const certificate = std::get_if<owned<X509>>(&read);
  if (certificate == nullptr) {
    x.problem = std::get<std::string>(read);
  } else if (!describe(x, **certificate)) {
    x.problem = path + std::string(ending) + ": no valid times";
  } else {
    x.signed_by_authority = is_signed_by(authority, **certificate);
    x.revoked = revoked ? revoked_at(*revoked, **certificate) : std::nullopt;
  }
  x.key = state_of_key(path + ".key", certificate == nullptr ? nullptr : certificate->get());
  ERR_clear_error();
  return x;
}

/// Names without ending, the authority's first.
std::vector<std::string> stems_in(const std::string& folder, std::error_code& error) {
  std::vector<std::string> all;
  for (std::filesystem::directory_iterator at(folder, error), end; !error && at != end;
       at.increment(error)) {
    const auto name = at->path().filename().string();
    if (name.size() > ending.size() && name.ends_with(ending))
      all.push_back(name.substr(0, name.size() - ending.size()));
  }
  std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) {
    return std::pair(a != authority_name, a) < std::pair(b != authority_name, b);
  });
  return all;
}

} // namespace

std::string_view to_string(key_state x) {
  switch (x) {
  case key_state::safe:
    return "safe";
  case key_state::missing:
    return "missing";
  case key_state::exposed:
    return "exposed";
  case key_state::unreadable:
    return "unreadable";
  case key_state::foreign:
    return "foreign";
  }
  return {};
}

std::string_view to_string(certificate_use x) {
  switch (x) {
  case certificate_use::any:
    return "any";
  case certificate_use::host:
    return "host";
  case certificate_use::coordinator:
    return "coordinator";
  case certificate_use::none:
    return "none";
  }
  return {};
}

bool is_good(const listed_certificate& x, std::chrono::sys_seconds now) {
  return x.problem.empty() && x.signed_by_authority && !x.revoked && x.valid_from <= now &&
         now < x.valid_until && (x.key == key_state::safe || x.key == key_state::missing);
}

std::variant<std::vector<listed_certificate>, std::string>
list_certificates(const std::string& folder) {
  const auto authority =
      read_certificate(folder + '/' + std::string(authority_name) + std::string(ending));
  if (const auto* why = std::get_if<std::string>(&authority))
    return *why;
  std::error_code error;
  const auto stems = stems_in(folder, error);
  if (error)
    return folder + ": " + error.message();
  const auto path = path_in(folder, authority_name, ending);
  const auto list = revocations_beside(path);
  const auto revoked = read_revocations(list, path, system_time());
  const auto* const why = std::get_if<std::string>(&revoked);
  std::vector<listed_certificate> all;
  all.reserve(stems.size() + 1);
  for (const auto& stem : stems)
    all.push_back(look_at(folder, stem, *std::get<owned<X509>>(authority),
                          why == nullptr ? std::get<0>(revoked) : std::nullopt));
  if (why != nullptr) {
    auto& x = all.emplace_back();
    x.file = std::filesystem::path(list).filename().string();
    x.name = x.file;
    x.problem = *why;
  }
  return all;
}

} // namespace rubicon::io
