// For files of this room only: certificates and keys in memory, and in files as PEM.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include <openssl/bio.h>
#include <openssl/bn.h>
#include <openssl/evp.h>
#include <openssl/x509.h>
#include <openssl/x509v3.h>

#include "io/files/file_lock.hpp"
#include "io/tls/certificates.hpp"

namespace rubicon::io {

struct openssl_free {
  void operator()(BIO* x) const { BIO_free_all(x); }
  void operator()(BIGNUM* x) const { BN_free(x); }
  void operator()(EVP_PKEY* x) const { EVP_PKEY_free(x); }
  void operator()(X509* x) const { X509_free(x); }
  void operator()(X509_CRL* x) const { X509_CRL_free(x); }
  void operator()(X509_REVOKED* x) const { X509_REVOKED_free(x); }
  void operator()(X509_EXTENSION* x) const { X509_EXTENSION_free(x); }
  void operator()(X509_STORE* x) const { X509_STORE_free(x); }
  void operator()(X509_STORE_CTX* x) const { X509_STORE_CTX_free(x); }
  void operator()(GENERAL_NAME* x) const { GENERAL_NAME_free(x); }
  void operator()(GENERAL_NAMES* x) const { GENERAL_NAMES_free(x); }
  void operator()(ASN1_STRING* x) const { ASN1_STRING_free(x); } ///< ASN1_TIME, _INTEGER: the same
};

/// An object of OpenSSL that ends with its owner.
template <class T>
using owned = std::unique_ptr<T, openssl_free>;

/// Why OpenSSL's last call failed: `OpenSSL: no start line`. Forgets it and all before it.
[[nodiscard]] std::string openssl_reason();

/// Of a file that may hold anything: no certificate, no end, a key that somebody has put under a
/// password (nobody is asked for it).
/// @returns the first certificate of the file, or why there is none, beginning with the path
[[nodiscard]] std::variant<owned<X509>, std::string> read_certificate(const std::string& path);

/// The same for a private key.
[[nodiscard]] std::variant<owned<EVP_PKEY>, std::string> read_key(const std::string& path);

/// Empty if it has none.
[[nodiscard]] std::string common_name_of(const X509& x);

/// As its extended key usage says; any if it does not say it.
[[nodiscard]] certificate_use use_of(const X509& x);

/// The time of a certificate; nothing for one that no calendar has.
[[nodiscard]] std::optional<std::chrono::sys_seconds> time_of(const ASN1_TIME& x);

/// When a certificate ends to be valid.
[[nodiscard]] inline std::optional<std::chrono::sys_seconds> end_of(const X509& x) {
  return time_of(*X509_get0_notAfter(&x));
}

/// A certificate and its key, about to be written to files.
struct certificate_pair {
  owned<X509> certificate;
  owned<EVP_PKEY> key;
};

/// Writes a file for everybody to read in the place of the one that is there, at once.
/// @returns why not
[[nodiscard]] std::optional<std::string> replace_with(const std::string& path, BIO& octets);

/// A place in memory that OpenSSL wipes when it is given back.
[[nodiscard]] owned<BIO> memory();

/// `folder/NAME.crt`
[[nodiscard]] std::string path_in(const std::string& folder, std::string_view name,
                                  std::string_view ending);

/// The authority of a folder, with its key; or why it cannot sign at that time.
[[nodiscard]] std::variant<certificate_pair, std::string>
read_authority(const std::string& folder, std::chrono::sys_seconds now);

/// Where a folder has the certificates that others have taken the place of: HOST-SERIAL.crt
[[nodiscard]] std::string former_in(const std::string& folder);

/// Puts a pair, or a certificate without key, in the place of that of a host, which is stored
/// there.
/// @returns why not
[[nodiscard]] std::optional<std::string> replace_files(const certificate_pair& x, const X509& old,
                                                       const std::string& folder,
                                                       const std::string& host);

/// Keeps two commands from changing one folder. Makes the file there.
[[nodiscard]] std::variant<file_lock, std::string> lock_of(const std::string& folder);

/// Makes both files, neither of which may be there: the key for its owner only, before it has any
/// content. Leaves none of them if it cannot make both.
/// @returns why not, beginning with the path of the file in question
[[nodiscard]] std::optional<std::string> create_files(const certificate_pair& x,
                                                      const std::string& certificate_path,
                                                      const std::string& key_path);

} // namespace rubicon::io
