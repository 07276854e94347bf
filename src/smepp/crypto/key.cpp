#include "smepp/crypto/key.hpp"

#include <algorithm>

#include <openssl/crypto.h>

#include "smepp/crypto/cipher.hpp"

namespace rubicon::smepp {

key::~key() {
  OPENSSL_cleanse(octets_.data(), octets_.size());
}

std::optional<key> key::from_hex(std::string_view hex) {
  const auto octets = rubicon::from_hex(hex);
  if (!octets || octets->size() != size)
    return std::nullopt;
  key x;
  std::ranges::copy(*octets, x.octets_.begin());
  return x;
}

std::string key::fingerprint() const {
  return to_hex(byte_view(cmac(*this, to_bytes("fingerprint"))).first(2));
}

bool operator==(const key& a, const key& b) {
  return CRYPTO_memcmp(a.octets_.data(), b.octets_.data(), key::size) == 0;
}

} // namespace rubicon::smepp
