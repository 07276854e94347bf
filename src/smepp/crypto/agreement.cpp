#include "smepp/crypto/agreement.hpp"

#include <memory>

#include <openssl/crypto.h>
#include <openssl/evp.h>

#include "core/bytes.hpp"
#include "smepp/crypto/cipher.hpp"
#include "smepp/crypto/library.hpp"

namespace rubicon::smepp {

namespace {

using key_object = std::unique_ptr<EVP_PKEY, releaser<EVP_PKEY_free>>;
using key_context = std::unique_ptr<EVP_PKEY_CTX, releaser<EVP_PKEY_CTX_free>>;

key_object object_of(const agreement::secret& x) {
  key_object made(EVP_PKEY_new_raw_private_key(EVP_PKEY_X25519, nullptr, x.data(), x.size()));
  require(made != nullptr);
  return made;
}

} // namespace

agreement::~agreement() {
  OPENSSL_cleanse(secret_.data(), secret_.size());
}

agreement agreement::make(randomness& from) {
  secret x{};
  from.fill(x);
  return agreement(x);
}

key_share agreement::share() const {
  key_share x{};
  std::size_t size = x.size();
  require(EVP_PKEY_get_raw_public_key(object_of(secret_).get(), x.data(), &size) == 1 &&
          size == x.size());
  return x;
}

std::optional<agreement::secret> agreement::shared_secret(const key_share& other) const {
  const auto own = object_of(secret_);
  const key_object theirs(
      EVP_PKEY_new_raw_public_key(EVP_PKEY_X25519, nullptr, other.data(), other.size()));
  const key_context context(EVP_PKEY_CTX_new(own.get(), nullptr));
  require(theirs != nullptr && context != nullptr && EVP_PKEY_derive_init(context.get()) == 1 &&
          EVP_PKEY_derive_set_peer(context.get(), theirs.get()) == 1);
  secret x{};
  std::size_t size = x.size();
  if (EVP_PKEY_derive(context.get(), x.data(), &size) != 1 || size != x.size())
    return std::nullopt; // a share of low order: all would agree on zeros (RFC 7748 6.1)
  return x;
}

std::optional<key> agreement::agree(const key_share& other) const {
  auto x = shared_secret(other);
  if (!x)
    return std::nullopt;
  const auto made = hkdf(*x, "agreed");
  OPENSSL_cleanse(x->data(), x->size());
  return made;
}

} // namespace rubicon::smepp
