#include "smepp/crypto/randomness.hpp"

#include <openssl/rand.h>

#include "smepp/crypto/library.hpp"

namespace rubicon::smepp {

void randomness::fill(std::span<std::uint8_t> octets) {
  if (!stream_)
    return require(RAND_priv_bytes(octets.data(), static_cast<int>(octets.size())) == 1);
  std::uint64_t drawn = 0;
  for (std::size_t i = 0; i < octets.size(); ++i) {
    if (i % 8 == 0)
      drawn = stream_->next();
    octets[i] = static_cast<std::uint8_t>(drawn >> 8 * (i % 8));
  }
}

} // namespace rubicon::smepp
