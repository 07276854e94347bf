#include "smepp/crypto/cipher.hpp"

#include <algorithm>
#include <memory>

#include <openssl/core_names.h>
#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <openssl/kdf.h>
#include <openssl/params.h>

#include "core/codec.hpp"
#include "smepp/crypto/library.hpp"

namespace rubicon::smepp {

namespace {

using cipher_context = std::unique_ptr<EVP_CIPHER_CTX, releaser<EVP_CIPHER_CTX_free>>;
using kdf_context = std::unique_ptr<EVP_KDF_CTX, releaser<EVP_KDF_CTX_free>>;
using mac_context = std::unique_ptr<EVP_MAC_CTX, releaser<EVP_MAC_CTX_free>>;

/// Looking an algorithm up takes longer than to use it; what is found never changes.
const EVP_CIPHER* ctr_algorithm() {
  static const std::unique_ptr<EVP_CIPHER, releaser<EVP_CIPHER_free>> found(
      EVP_CIPHER_fetch(nullptr, "AES-128-CTR", nullptr));
  require(found != nullptr);
  return found.get();
}

EVP_MAC* cmac_algorithm() {
  static const std::unique_ptr<EVP_MAC, releaser<EVP_MAC_free>> found(
      EVP_MAC_fetch(nullptr, "CMAC", nullptr));
  require(found != nullptr);
  return found.get();
}

EVP_KDF* hkdf_algorithm() {
  static const std::unique_ptr<EVP_KDF, releaser<EVP_KDF_free>> found(
      EVP_KDF_fetch(nullptr, "HKDF", nullptr));
  require(found != nullptr);
  return found.get();
}

} // namespace

void apply_ctr(const key& under, const block& first, std::span<std::uint8_t> octets) {
  const cipher_context context(EVP_CIPHER_CTX_new());
  require(context != nullptr &&
          EVP_EncryptInit_ex2(context.get(), ctr_algorithm(), under.reveal().data(), first.data(),
                              nullptr) == 1);
  int written = 0;
  require(octets.empty() || EVP_EncryptUpdate(context.get(), octets.data(), &written, octets.data(),
                                              static_cast<int>(octets.size())) == 1);
}

block cmac(const key& under, byte_view octets) {
  const mac_context context(EVP_MAC_CTX_new(cmac_algorithm()));
  char name[] = "AES-128-CBC";
  const OSSL_PARAM parameters[] = {OSSL_PARAM_construct_utf8_string(OSSL_MAC_PARAM_CIPHER, name, 0),
                                   OSSL_PARAM_construct_end()};
  block result{};
  std::size_t size = 0;
  require(context != nullptr &&
          EVP_MAC_init(context.get(), under.reveal().data(), key::size, parameters) == 1 &&
          EVP_MAC_update(context.get(), octets.data(), octets.size()) == 1 &&
          EVP_MAC_final(context.get(), result.data(), &size, result.size()) == 1 &&
          size == result.size());
  return result;
}

tag short_mac(const key& under, byte_view octets) {
  const auto whole = cmac(under, octets);
  tag x{};
  std::copy_n(whole.begin(), x.size(), x.begin());
  return x;
}

bool is_same(const tag& a, const tag& b) {
  return CRYPTO_memcmp(a.data(), b.data(), a.size()) == 0;
}

key derive(const key& from, std::string_view label, byte_view context) {
  byte_writer input;
  input.octet(1).append(to_bytes(label)).octet(0).append(context).big(std::uint16_t{128});
  return key(cmac(from, input.view()));
}

key hkdf(byte_view secret, std::string_view label) {
  const kdf_context context(EVP_KDF_CTX_new(hkdf_algorithm()));
  char digest[] = "SHA256";
  auto input = to_bytes(secret);
  auto info = to_bytes(label);
  const OSSL_PARAM parameters[] = {
      OSSL_PARAM_construct_utf8_string(OSSL_KDF_PARAM_DIGEST, digest, 0),
      OSSL_PARAM_construct_octet_string(OSSL_KDF_PARAM_KEY, input.data(), input.size()),
      OSSL_PARAM_construct_octet_string(OSSL_KDF_PARAM_INFO, info.data(), info.size()),
      OSSL_PARAM_construct_end()};
  std::array<std::uint8_t, key::size> made{};
  require(context != nullptr &&
          EVP_KDF_derive(context.get(), made.data(), made.size(), parameters) == 1);
  const key result(made);
  OPENSSL_cleanse(input.data(), input.size());
  OPENSSL_cleanse(made.data(), made.size());
  return result;
}

tag short_hash(byte_view octets) {
  std::array<std::uint8_t, 32> whole{};
  require(EVP_Digest(octets.data(), octets.size(), whole.data(), nullptr, EVP_sha256(), nullptr) ==
          1);
  tag x{};
  std::copy_n(whole.begin(), x.size(), x.begin());
  return x;
}

} // namespace rubicon::smepp
