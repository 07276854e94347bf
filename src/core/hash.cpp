#include "core/hash.hpp"

namespace rubicon {

std::string to_hex(std::uint64_t x) {
  std::string text(16, '0');
  for (std::size_t i = 16; i-- > 0; x >>= 4)
    text[i] = "0123456789abcdef"[x & 0x0f];
  return text;
}

} // namespace rubicon
