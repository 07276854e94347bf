// Folders of certificates, and what is in their files.
#pragma once

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509.h>
#include <openssl/x509_vfy.h>
#include <openssl/x509v3.h>

#include "io/tls/certificates.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"

namespace rubicon::test {

namespace fs = std::filesystem;

inline constexpr std::chrono::sys_seconds today =
    std::chrono::sys_days(std::chrono::year(2027) / 3 / 1) + std::chrono::hours(9);

struct openssl_free {
  void operator()(X509* x) const { X509_free(x); }
  void operator()(EVP_PKEY* x) const { EVP_PKEY_free(x); }
  void operator()(X509_STORE* x) const { X509_STORE_free(x); }
  void operator()(X509_STORE_CTX* x) const { X509_STORE_CTX_free(x); }
  void operator()(GENERAL_NAMES* x) const { GENERAL_NAMES_free(x); }
};

template <class T>
using owned = std::unique_ptr<T, openssl_free>;
using opened_file = std::unique_ptr<std::FILE, decltype(&std::fclose)>;

inline owned<X509> certificate_of(const std::string& path) {
  const opened_file file(std::fopen(path.c_str(), "re"), &std::fclose);
  REQUIRE(file);
  owned<X509> x(PEM_read_X509(file.get(), nullptr, nullptr, nullptr));
  REQUIRE(x);
  return x;
}

inline owned<EVP_PKEY> key_of(const std::string& path) {
  const opened_file file(std::fopen(path.c_str(), "re"), &std::fclose);
  REQUIRE(file);
  owned<EVP_PKEY> x(PEM_read_PrivateKey(file.get(), nullptr, nullptr, nullptr));
  REQUIRE(x);
  return x;
}

template <class T>
T good(std::variant<T, std::string> x) {
  if (const auto* why = std::get_if<std::string>(&x))
    FAIL(*why);
  return std::get<T>(std::move(x));
}

template <class T>
std::string refusal(const std::variant<T, std::string>& x) {
  const auto* why = std::get_if<std::string>(&x);
  return why == nullptr ? "" : *why;
}

inline io::made_certificate make_host(const std::string& folder, const std::string& host,
                                      std::vector<std::string> addresses = {}) {
  return good(io::make_certificate(folder, {host, std::move(addresses)}, today));
}

inline void put(const std::string& path, const std::string& content) {
  std::ofstream(path, std::ios::binary) << content;
}

/// The row of a name in the list.
inline io::listed_certificate listed(const std::string& folder, const std::string& name) {
  for (auto& x : good(io::list_certificates(folder))) {
    if (x.name == name)
      return x;
  }
  FAIL("not in the list: " << name);
  return {};
}

} // namespace rubicon::test
